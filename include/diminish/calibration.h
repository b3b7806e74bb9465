#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diminish/board.h"
#include "diminish/export.h"
#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// A board's corners in one image.
struct BoardView {
  std::string name;                       ///< the image's
  std::vector<int> ids;                   ///< of the corners: their index on the board
  std::vector<Eigen::Vector2d> pixels;    ///< of the (distorted) image
  std::vector<Eigen::Vector3d> points_m;  ///< in the board's frame; z = 0
};

/// Finds a board in images.
class DIMINISH_EXPORT BoardDetector {
 public:
  /// Throws Error on impossible boards.
  explicit BoardDetector(const Board& board);
  ~BoardDetector();
  BoardDetector(BoardDetector&&) noexcept;
  BoardDetector& operator=(BoardDetector&&) noexcept;

  /// The corners with sub-pixel accuracy; nothing if the board is not found. All corners of a
  /// checkerboard must be visible (cv::findChessboardCornersSB), of a ChArUco board six that are
  /// not on one line.
  std::optional<BoardView> detect(ImageView<Bgr> image, const std::string& name) const;

 private:
  struct Implementation;
  std::unique_ptr<const Implementation> implementation_;
};

/// Collects views of a board for calibrating a camera. Keeps about a hundred at most.
class DIMINISH_EXPORT ViewCollection {
 public:
  ViewCollection(int width, int height);

  /// Keeps the view if it helps and returns an empty text. Otherwise returns why it does not help,
  /// in plain words.
  std::string add(BoardView view);

  const std::vector<BoardView>& views() const { return views_; }
  int width() const { return width_; }
  int height() const { return height_; }

  /// The number of views with a corner in each cell of the image.
  const Image<int>& cells() const { return cells_; }
  /// The share of cells that have a corner.
  double coverage() const;
  /// How many of five tilts were seen: facing the camera, or tilted left, right, forward or back by
  /// 15 degrees or more. Tilted boards separate the focal length from the distance.
  int tilts() const;
  /// Whether more views would hardly help: there are twenty, with all tilts, nearly everywhere.
  bool is_ample() const;

 private:
  int width_, height_;
  Image<int> cells_;
  std::array<int, 5> tilt_counts_{};
  std::vector<BoardView> views_;
};

/// The result of a calibration.
struct IntrinsicsCalibration {
  struct View {
    std::string name;
    double error_px;  ///< root mean square over its corners
    bool used;        ///< false: left out because it disagrees with the others
  };

  Intrinsics intrinsics;
  /// Standard deviations of fx, fy, cx, cy and the distortion coefficients, in the lens model's
  /// order; 0 for parameters that were not fitted.
  std::array<double, 12> deviations{};
  double error_px = 0;  ///< root mean square over the corners of the views used
  std::vector<View> views;
  /// Each corner's reprojection error by view, pixels: seen minus computed.
  std::vector<std::vector<Eigen::Vector2d>> residuals_px;
  /// Why the figures may be wrong, in plain words.
  std::vector<std::string> warnings;
};

/// Calibrates a camera (Zhang 2000, by cv::calibrateCamera or cv::fisheye::calibrate). Views whose
/// error stands out are left out. A plumb-bob lens's k3 is fitted only if it is more than three
/// standard deviations from 0. Throws Error with fewer than three views, or if no camera explains
/// them. Cost: some seconds for a hundred views.
DIMINISH_EXPORT IntrinsicsCalibration calibrate_intrinsics(const ViewCollection& views,
                                                           LensModel model = LensModel::plumb_bob);

}  // namespace diminish
