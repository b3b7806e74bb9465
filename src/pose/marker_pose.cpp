#include "pose/marker_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <vector>

namespace diminish {
namespace {

/// A marker's corners as pixels of an ideal camera: no lens, focal length as the real one's.
struct IdealView {
  std::vector<cv::Point2d> pixels;
  cv::Matx33d camera_matrix;
};

IdealView undistort(const std::array<Eigen::Vector2d, 4>& corners, const Lens& lens) {
  const double fx = lens.intrinsics().fx;
  const double fy = lens.intrinsics().fy;
  IdealView view{{}, {fx, 0, 0, 0, fy, 0, 0, 0, 1}};
  for (const Eigen::Vector2d& corner : corners) {
    const Eigen::Vector2d ray = lens.undistort(corner);
    view.pixels.emplace_back(ray.x() * fx, ray.y() * fy);
  }
  return view;
}

bool is_convex_clockwise(const std::vector<cv::Point2d>& p) {
  for (std::size_t i = 0; i < 4; ++i) {
    const cv::Point2d a = p[(i + 1) % 4] - p[i];
    const cv::Point2d b = p[(i + 2) % 4] - p[(i + 1) % 4];
    constexpr double min_sine = 0.02;
    if (!(a.cross(b) > min_sine * cv::norm(a) * cv::norm(b))) return false;
  }
  return true;
}

double reprojection_error(const std::vector<cv::Point3d>& points, const IdealView& view,
                          const cv::Vec3d& rotation, const cv::Vec3d& translation) {
  std::vector<cv::Point2d> projected;
  cv::projectPoints(points, rotation, translation, view.camera_matrix, cv::noArray(), projected);
  double squares = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const cv::Point2d difference = projected[i] - view.pixels[i];
    squares += difference.dot(difference);
  }
  return std::sqrt(squares / 4);
}

/// The solver works on a marker frame with y down and z into the marker: an upright marker that
/// faces the camera is then not turned at all. In the marker's own frame it is turned by 180
/// degrees, where rotation vectors jump and OpenCV's solvers fail.
const Eigen::Matrix3d solver_from_marker = Eigen::Vector3d(1, -1, -1).asDiagonal();

RigidTransform to_transform(const cv::Vec3d& rotation, const cv::Vec3d& translation) {
  cv::Matx33d matrix;
  cv::Rodrigues(rotation, matrix);
  RigidTransform camera_from_solver;
  cv::cv2eigen(matrix, camera_from_solver.rotation);
  camera_from_solver.translation = {translation[0], translation[1], translation[2]};
  return camera_from_solver * RigidTransform{solver_from_marker, Eigen::Vector3d::Zero()};
}

struct Solution {
  RigidTransform pose;
  double error_px;
};

}  // namespace

std::array<Eigen::Vector3d, 4> marker_corners(double size_m) {
  const double h = size_m / 2;
  return {Eigen::Vector3d(-h, h, 0), Eigen::Vector3d(h, h, 0), Eigen::Vector3d(h, -h, 0),
          Eigen::Vector3d(-h, -h, 0)};
}

double marker_error_px(const RigidTransform& camera_from_marker, double size_m, const Lens& lens,
                       const std::array<Eigen::Vector2d, 4>& corners) {
  double squares = 0;
  const auto points = marker_corners(size_m);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto pixel = lens.project(camera_from_marker * points[i]);
    if (!pixel) return std::numeric_limits<double>::infinity();
    squares += (*pixel - corners[i]).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(corners.size()));
}

std::optional<MarkerPose> estimate_marker_pose(const std::array<Eigen::Vector2d, 4>& corners,
                                               double size_m, const Lens& lens) {
  const IdealView view = undistort(corners, lens);
  if (!is_convex_clockwise(view.pixels)) return std::nullopt;
  std::vector<cv::Point3d> points;
  for (const Eigen::Vector3d& in_marker : marker_corners(size_m)) {
    const Eigen::Vector3d corner = solver_from_marker * in_marker;
    points.emplace_back(corner.x(), corner.y(), corner.z());
  }
  std::vector<cv::Vec3d> rotations;
  std::vector<cv::Vec3d> translations;
  cv::solvePnPGeneric(points, view.pixels, view.camera_matrix, cv::noArray(), rotations,
                      translations, false, cv::SOLVEPNP_IPPE);
  std::vector<Solution> solutions;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    cv::solvePnPRefineLM(points, view.pixels, view.camera_matrix, cv::noArray(), rotations[i],
                         translations[i]);
    const double error = reprojection_error(points, view, rotations[i], translations[i]);
    if (std::isfinite(error) && translations[i][2] > 0) {
      solutions.push_back({to_transform(rotations[i], translations[i]), error});
    }
  }
  if (solutions.empty()) return std::nullopt;
  std::stable_sort(solutions.begin(), solutions.end(),
                   [](const Solution& a, const Solution& b) { return a.error_px < b.error_px; });
  const Solution& best = solutions.front();
  const Solution& second = solutions.back();
  // Refinement can lead both to the same pose: then there is nothing to choose between.
  const bool two = rotation_difference_deg(best.pose.rotation, second.pose.rotation) > 0.5;
  return MarkerPose{best.pose, best.error_px, second.pose,
                    two ? best.error_px / std::max(second.error_px, 1e-12) : 0};
}

}  // namespace diminish
