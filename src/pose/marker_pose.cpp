#include "pose/marker_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/rotation.h"

namespace diminish {
namespace {

/// A marker's corners as pixels of an ideal camera: no lens, focal length as the real one's.
struct IdealView {
  std::array<Eigen::Vector2d, 4> pixels;
  double fx, fy;

  Eigen::Vector2d project(const Eigen::Vector3d& p) const {
    return {fx * p.x() / p.z(), fy * p.y() / p.z()};
  }
};

IdealView undistort(const std::array<Eigen::Vector2d, 4>& corners, const Lens& lens) {
  IdealView view{{}, lens.intrinsics().fx, lens.intrinsics().fy};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d ray = lens.undistort(corners[i]);
    view.pixels[i] = {ray.x() * view.fx, ray.y() * view.fy};
  }
  return view;
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool is_convex_clockwise(const std::array<Eigen::Vector2d, 4>& p) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = p[(i + 1) % 4] - p[i];
    const Eigen::Vector2d b = p[(i + 2) % 4] - p[(i + 1) % 4];
    constexpr double min_sine = 0.02;
    if (!(cross(a, b) > min_sine * a.norm() * b.norm())) return false;
  }
  return true;
}

using Corners = std::array<Eigen::Vector3d, 4>;

/// Root mean square over the corners, pixels.
double reprojection_error(const Corners& corners, const IdealView& view,
                          const RigidTransform& camera_from_corners) {
  double squares = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    squares += (view.project(camera_from_corners * corners[i]) - view.pixels[i]).squaredNorm();
  }
  return std::sqrt(squares / 4);
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
      normal += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * (view.pixels[i] - view.project(p));
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
/// faces the camera is then not turned at all.
const RigidTransform solver_from_marker{Eigen::Vector3d(1, -1, -1).asDiagonal(),
                                        Eigen::Vector3d::Zero()};

/// camera_from_solver from the homography of the marker's plane (Zhang 2000), which is exact for
/// exact corners.
RigidTransform pose_from_homography(const IdealView& view, double size_m) {
  std::array<Eigen::Vector2d, 4> p;
  for (std::size_t i = 0; i < 4; ++i) {
    p[i] = {view.pixels[i].x() / view.fx, view.pixels[i].y() / view.fy};
  }
  // From the unit square to the four points (Heckbert 1989).
  const Eigen::Vector2d a = p[1] - p[2];
  const Eigen::Vector2d b = p[3] - p[2];
  const Eigen::Vector2d sum = p[0] - p[1] + p[2] - p[3];
  const double g = cross(sum, b) / cross(a, b);
  const double h = cross(a, sum) / cross(a, b);
  Eigen::Matrix3d homography;
  homography.col(0) << p[1] - p[0] + g * p[1], g;
  homography.col(1) << p[3] - p[0] + h * p[3], h;
  homography.col(2) << p[0], 1;

  Eigen::Matrix3d axes;
  axes.col(0) = homography.col(0) / size_m;
  axes.col(1) = homography.col(1) / size_m;
  Eigen::Vector3d center = homography * Eigen::Vector3d(0.5, 0.5, 1);
  const double scale = 2 / (axes.col(0).norm() + axes.col(1).norm());
  axes.leftCols<2>() *= scale;
  center *= scale;
  axes.col(2) = axes.col(0).cross(axes.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU() * svd.matrixV().transpose(), center};
}

/// The pose that looks the same from afar: the marker's plane, mirrored about the line of sight
/// (Schweighofer & Pinz 2006).
RigidTransform mirrored(const RigidTransform& camera_from_solver) {
  const Eigen::Matrix3d sight_from_camera =
      Eigen::Quaterniond::FromTwoVectors(camera_from_solver.translation, Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  const Eigen::Matrix3d flip = Eigen::Vector3d(1, 1, -1).asDiagonal();
  return {
      sight_from_camera.transpose() * flip * sight_from_camera * camera_from_solver.rotation * flip,
      camera_from_solver.translation};
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
  Corners points = marker_corners(size_m);
  for (Eigen::Vector3d& point : points) point = solver_from_marker * point;
  const RigidTransform start = pose_from_homography(view, size_m);
  std::array<Solution, 2> solutions;
  std::size_t count = 0;
  for (RigidTransform pose : {start, mirrored(start)}) {
    const double error = refine(points, view, pose);
    if (!std::isfinite(error) || !(pose.translation.z() > 0)) continue;
    solutions[count++] = {pose * solver_from_marker, error};
  }
  if (count == 0) return std::nullopt;
  if (count == 1) solutions[1] = solutions[0];
  if (solutions[1].error_px < solutions[0].error_px) std::swap(solutions[0], solutions[1]);
  const Solution& best = solutions.front();
  const Solution& second = solutions.back();
  // Refinement can lead both to the same pose: then there is nothing to choose between.
  const bool two = rotation_difference_deg(best.pose.rotation, second.pose.rotation) > 0.5;
  return MarkerPose{best.pose, best.error_px, second.pose,
                    two ? best.error_px / std::max(second.error_px, 1e-12) : 0};
}

}  // namespace diminish
