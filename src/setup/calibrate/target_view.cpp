#include "setup/calibrate/target_view.h"

#include <opencv2/calib3d.hpp>

#include "pose/marker_pose.h"

namespace diminish {
namespace {

TargetView from_marker(const Marker& marker, double size_m, const MarkerPose& pose) {
  TargetView view;
  view.id = marker.id;
  const auto corners = marker_corners(size_m);
  view.points_m.assign(corners.begin(), corners.end());
  view.pixels.assign(marker.corners.begin(), marker.corners.end());
  view.camera_from_target = pose.camera_from_marker;
  view.alternative = pose.alternative;
  view.doubtful = pose.is_doubtful();
  view.error_px = pose.error_px;
  view.high = Eigen::Vector2d::Constant(size_m / 2);
  view.low = -view.high;
  return view;
}

RigidTransform from_opencv(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  cv::Matx33d rotation;
  cv::Rodrigues(rotation_vector, rotation);
  RigidTransform transform;
  for (int i = 0; i < 9; ++i) transform.rotation(i / 3, i % 3) = rotation.val[i];
  for (int i = 0; i < 3; ++i) transform.translation[i] = translation.at<double>(i);
  return transform;
}

std::optional<TargetView> from_board(BoardView&& board, const Lens& lens) {
  TargetView view;
  view.id = TargetView::board_id;
  view.points_m = std::move(board.points_m);
  view.pixels = std::move(board.pixels);
  view.low = view.high = view.points_m.front().head<2>();
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> rays;
  for (std::size_t i = 0; i < view.points_m.size(); ++i) {
    const Eigen::Vector3d& p = view.points_m[i];
    view.low = view.low.cwiseMin(p.head<2>());
    view.high = view.high.cwiseMax(p.head<2>());
    const Eigen::Vector2d ray = lens.undistort(view.pixels[i]);
    points.emplace_back(p.x(), p.y(), 0);
    rays.emplace_back(ray.x(), ray.y());
  }
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  std::vector<double> errors;
  const cv::Matx33d ideal = cv::Matx33d::eye();
  try {
    cv::solvePnPGeneric(points, rays, ideal, cv::noArray(), rotations, translations, false,
                        cv::SOLVEPNP_IPPE, cv::noArray(), cv::noArray(), errors);
    for (std::size_t i = 0; i < rotations.size(); ++i) {
      cv::solvePnPRefineLM(points, rays, ideal, cv::noArray(), rotations[i], translations[i]);
    }
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  if (rotations.empty()) return std::nullopt;
  const auto error_px = [&](const RigidTransform& camera_from_target) {
    double squares = 0;
    for (std::size_t i = 0; i < view.points_m.size(); ++i) {
      const auto pixel = lens.project(camera_from_target * view.points_m[i]);
      if (!pixel) return std::numeric_limits<double>::infinity();
      squares += (*pixel - view.pixels[i]).squaredNorm();
    }
    return std::sqrt(squares / static_cast<double>(view.points_m.size()));
  };
  view.camera_from_target = from_opencv(rotations[0], translations[0]);
  view.alternative = from_opencv(rotations.back(), translations.back());
  view.error_px = error_px(view.camera_from_target);
  double other = error_px(view.alternative);
  if (other < view.error_px) {
    std::swap(view.camera_from_target, view.alternative);
    std::swap(view.error_px, other);
  }
  view.doubtful =
      rotation_difference_deg(view.camera_from_target.rotation, view.alternative.rotation) > 0.5 &&
      view.error_px > doubtful_ambiguity * other;
  if (!std::isfinite(view.error_px)) return std::nullopt;
  return view;
}

}  // namespace

TargetFinder::TargetFinder(const std::string& dictionary, std::map<int, double> marker_sizes_m,
                           const std::optional<Board>& board)
    : marker_sizes_m_(std::move(marker_sizes_m)), markers_(dictionary) {
  if (board) board_.emplace(*board);
}

std::vector<TargetView> TargetFinder::find(ImageView<Bgr> image, const Lens& lens) {
  std::vector<TargetView> views;
  if (board_) {
    if (auto board = board_->detect(image, "")) {
      if (auto view = from_board(std::move(*board), lens)) views.push_back(std::move(*view));
    }
    return views;
  }
  markers_.detect(image, lens, found_);
  for (const Marker& marker : found_) {
    const auto size = marker_sizes_m_.find(marker.id);
    if (size == marker_sizes_m_.end()) continue;
    if (const auto pose = estimate_marker_pose(marker.corners, size->second, lens)) {
      views.push_back(from_marker(marker, size->second, *pose));
    }
  }
  return views;
}

}  // namespace diminish
