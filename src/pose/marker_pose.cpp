#include "pose/marker_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <vector>

namespace diminish {
namespace {

/// A marker's corners as pixels of an ideal camera: no lens, focal length as the real one's.
struct IdealView {
  std::array<Eigen::Vector2d, 4> pixels;
  double fx, fy;
};

IdealView undistort(const std::array<Eigen::Vector2d, 4>& corners, const Lens& lens) {
  IdealView view{{}, lens.intrinsics().fx, lens.intrinsics().fy};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d ray = lens.undistort(corners[i]);
    view.pixels[i] = {ray.x() * view.fx, ray.y() * view.fy};
  }
  return view;
}

bool is_convex_clockwise(const std::array<Eigen::Vector2d, 4>& p) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = p[(i + 1) % 4] - p[i];
    const Eigen::Vector2d b = p[(i + 2) % 4] - p[(i + 1) % 4];
    constexpr double min_sine = 0.02;
    if (!(a.x() * b.y() - a.y() * b.x() > min_sine * a.norm() * b.norm())) return false;
  }
  return true;
}

using Corners = std::array<Eigen::Vector3d, 4>;

/// Root mean square over the corners, pixels.
double reprojection_error(const Corners& corners, const IdealView& view,
                          const RigidTransform& camera_from_corners) {
  double squares = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d p = camera_from_corners * corners[i];
    const Eigen::Vector2d projected(view.fx * p.x() / p.z(), view.fy * p.y() / p.z());
    squares += (projected - view.pixels[i]).squaredNorm();
  }
  return std::sqrt(squares / 4);
}

Eigen::Matrix3d rotation_by(const Eigen::Vector3d& axis_times_angle) {
  const double angle = axis_times_angle.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, axis_times_angle / angle).toRotationMatrix();
}

/// Levenberg-Marquardt on the reprojection error; returns what is left of it, pixels.
double refine(const Corners& corners, const IdealView& view, RigidTransform& camera_from_corners) {
  constexpr int max_steps = 40;
  double error = reprojection_error(corners, view, camera_from_corners);
  double damping = 1e-3;
  for (int step = 0; step < max_steps && std::isfinite(error); ++step) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      // In camera coordinates, by the rotation about the marker's centre, then the translation.
      const Eigen::Vector3d arm = camera_from_corners.rotation * corners[i];
      const Eigen::Vector3d p = arm + camera_from_corners.translation;
      Eigen::Matrix<double, 2, 3> by_point;
      by_point << view.fx / p.z(), 0, -view.fx * p.x() / (p.z() * p.z()),  //
          0, view.fy / p.z(), -view.fy * p.y() / (p.z() * p.z());
      Eigen::Matrix3d by_rotation;  // minus the cross product's matrix
      by_rotation << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
      Eigen::Matrix<double, 2, 6> jacobian;
      jacobian << by_point * by_rotation, by_point;
      const Eigen::Vector2d projected(view.fx * p.x() / p.z(), view.fy * p.y() / p.z());
      normal += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * (view.pixels[i] - projected);
    }
    Eigen::Matrix<double, 6, 6> damped = normal;
    damped.diagonal() *= 1 + damping;
    const Eigen::Matrix<double, 6, 1> change = damped.ldlt().solve(gradient);
    const RigidTransform next{rotation_by(change.head<3>()) * camera_from_corners.rotation,
                              camera_from_corners.translation + change.tail<3>()};
    const double next_error = reprojection_error(corners, view, next);
    if (!(next_error < error)) {
      damping *= 10;
      if (damping > 1e6) break;
      continue;
    }
    const bool done = error - next_error <= 1e-12 * error;
    camera_from_corners = next;
    error = next_error;
    damping /= 10;
    if (done) break;
  }
  return error;
}

/// The solver works on a marker frame with y down and z into the marker: an upright marker that
/// faces the camera is then not turned at all. In the marker's own frame it is turned by 180
/// degrees, where rotation vectors jump and OpenCV's solvers fail.
const Eigen::Matrix3d solver_from_marker = Eigen::Vector3d(1, -1, -1).asDiagonal();

/// camera_from_solver.
RigidTransform to_transform(const cv::Vec3d& rotation, const cv::Vec3d& translation) {
  return {rotation_by({rotation[0], rotation[1], rotation[2]}),
          {translation[0], translation[1], translation[2]}};
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
  const RigidTransform solver_frame{solver_from_marker, Eigen::Vector3d::Zero()};
  Corners points = marker_corners(size_m);
  std::vector<cv::Point3d> object_points;
  std::vector<cv::Point2d> image_points;
  for (std::size_t i = 0; i < 4; ++i) {
    points[i] = solver_frame * points[i];
    object_points.emplace_back(points[i].x(), points[i].y(), points[i].z());
    image_points.emplace_back(view.pixels[i].x(), view.pixels[i].y());
  }
  std::vector<cv::Vec3d> rotations;
  std::vector<cv::Vec3d> translations;
  cv::solvePnPGeneric(object_points, image_points,
                      cv::Matx33d(view.fx, 0, 0, 0, view.fy, 0, 0, 0, 1), cv::noArray(), rotations,
                      translations, false, cv::SOLVEPNP_IPPE);
  std::vector<Solution> solutions;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    RigidTransform pose = to_transform(rotations[i], translations[i]);
    const double error = refine(points, view, pose);
    if (std::isfinite(error) && pose.translation.z() > 0) {
      solutions.push_back({pose * solver_frame, error});
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
