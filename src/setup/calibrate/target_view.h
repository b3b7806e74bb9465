#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "diminish/calibration.h"
#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/marker_detector.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// A marker or a board as a camera sees it. Its own frame has the target in the plane z = 0.
struct TargetView {
  static constexpr int board_id = -1;

  int id = 0;  ///< the marker's, or `board_id`
  /// Corners in the target's frame, and their places in the (distorted) image.
  std::vector<Eigen::Vector3d> points_m;
  std::vector<Eigen::Vector2d> pixels;
  /// The pose that explains the corners best, and the second one that a plane seen from afar has.
  RigidTransform camera_from_target, alternative;
  bool doubtful = false;  ///< whether the alternative may be right
  double error_px = 0;    ///< root mean square over the corners
  /// The surface that is known to be flat.
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();
};

/// Finds markers of known size, and a board.
class TargetFinder {
 public:
  TargetFinder(const std::string& dictionary, std::map<int, double> marker_sizes_m,
               const std::optional<Board>& board);

  /// Of a board's own markers, those that the scene knows are left out where a board is given.
  std::vector<TargetView> find(ImageView<Bgr> image, const Lens& lens);

 private:
  std::map<int, double> marker_sizes_m_;
  MarkerDetector markers_;
  std::optional<BoardDetector> board_;
  std::vector<Marker> found_;
};

}  // namespace diminish
