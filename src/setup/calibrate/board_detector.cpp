#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "core/mat.h"
#include "diminish/calibration.h"
#include "pose/aruco.h"

namespace diminish {
namespace {

/// Corners on a line determine no homography.
bool spans_a_plane(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& point : points) mean += point / static_cast<double>(points.size());
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (const auto& point : points) {
    const Eigen::Vector3d d = point - mean;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
  // The determinant divided by the squared trace: 1/4 for a disc, 0 for a line.
  return xx * yy - xy * xy > 0.005 * (xx + yy) * (xx + yy);
}

}  // namespace

struct BoardDetector::Implementation {
  Board board;
  std::optional<CharucoBoard> charuco;

  BoardView find_charuco(const cv::Mat& grey) const {
    BoardView view;
    for (const auto& [id, pixel] : charuco->detect(grey)) add(id, pixel, view);
    return view;
  }

  BoardView find_checkerboard(const cv::Mat& grey) const {
    BoardView view;
    std::vector<cv::Point2f> corners;
    if (!cv::findChessboardCornersSB(grey, {board.columns, board.rows}, corners,
                                     cv::CALIB_CB_NORMALIZE_IMAGE)) {
      return view;
    }
    for (std::size_t i = 0; i < corners.size(); ++i) add(static_cast<int>(i), corners[i], view);
    return view;
  }

  void add(int id, const cv::Point2f& corner, BoardView& view) const {
    const int columns = charuco ? board.columns - 1 : board.columns;
    view.ids.push_back(id);
    view.pixels.emplace_back(corner.x, corner.y);
    const int column = id % columns;
    const int row = id / columns;
    view.points_m.emplace_back(column * board.square_m, row * board.square_m, 0);
  }
};

BoardDetector::BoardDetector(const Board& board) {
  Implementation implementation{board, std::nullopt};
  if (board.kind == Board::Kind::charuco) implementation.charuco.emplace(board);
  implementation_ = std::make_unique<const Implementation>(std::move(implementation));
}
BoardDetector::~BoardDetector() = default;
BoardDetector::BoardDetector(BoardDetector&&) noexcept = default;
BoardDetector& BoardDetector::operator=(BoardDetector&&) noexcept = default;

std::optional<BoardView> BoardDetector::detect(ImageView<Bgr> image,
                                               const std::string& name) const {
  cv::Mat grey;
  cv::cvtColor(as_mat(image), grey, cv::COLOR_BGR2GRAY);
  const Implementation& self = *implementation_;
  BoardView view = self.charuco ? self.find_charuco(grey) : self.find_checkerboard(grey);
  constexpr std::size_t least_corners = 6;
  if (view.ids.size() < least_corners || !spans_a_plane(view.points_m)) return std::nullopt;
  view.name = name;
  return view;
}

}  // namespace diminish
