#include "pose/marker_pose.h"

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

namespace diminish {

std::optional<MarkerPose> estimate_marker_pose(const std::array<Eigen::Vector2d, 4>& corners,
                                               double size_m, const Lens& lens) {
  const double half = size_m / 2;
  const std::vector<cv::Point3d> square = {
      {-half, half, 0}, {half, half, 0}, {half, -half, 0}, {-half, -half, 0}};
  std::vector<cv::Point2d> rays;
  for (const Eigen::Vector2d& corner : corners) {
    const Eigen::Vector2d ray = lens.undistort(corner);
    rays.emplace_back(ray.x(), ray.y());
  }
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  cv::solvePnPGeneric(square, rays, cv::Matx33d::eye(), cv::noArray(), rotations, translations,
                      false, cv::SOLVEPNP_IPPE_SQUARE);

  MarkerPose result{{}, std::numeric_limits<double>::infinity(), 1, {}};
  double alternative_error = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    cv::solvePnPRefineLM(square, rays, cv::Matx33d::eye(), cv::noArray(), rotations[i],
                         translations[i]);
    cv::Matx33d rotation;
    cv::Rodrigues(rotations[i], rotation);
    RigidTransform pose;
    cv::cv2eigen(rotation, pose.rotation);
    cv::cv2eigen(translations[i], pose.translation);
    double squared_error = 0;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const auto pixel = lens.project(pose * Eigen::Vector3d(square[c].x, square[c].y, 0));
      squared_error +=
          pixel ? (*pixel - corners[c]).squaredNorm() : std::numeric_limits<double>::infinity();
    }
    const double error = std::sqrt(squared_error / 4);
    if (error < result.error_px) {
      alternative_error = result.error_px;
      result.alternative = result.camera_from_marker;
      result.camera_from_marker = pose;
      result.error_px = error;
    } else if (error < alternative_error) {
      alternative_error = error;
      result.alternative = pose;
    }
  }
  if (!std::isfinite(result.error_px)) return std::nullopt;
  if (!std::isfinite(alternative_error)) result.alternative = result.camera_from_marker;
  result.ambiguity = alternative_error > 0 ? result.error_px / alternative_error : 1;
  return result;
}

}  // namespace diminish
