#include "pose/marker_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/cross.h"
#include "geometry/homography.h"
#include "geometry/ideal_camera.h"
#include "geometry/rigid_least_squares.h"
#include "geometry/rotation.h"

namespace diminish {
namespace {

/// A marker's corners as an ideal camera sees them.
struct IdealView {
  IdealCamera camera;
  std::array<Eigen::Vector2d, 4> pixels;
};

IdealView undistort(const std::array<Eigen::Vector2d, 4>& corners, const Lens& lens) {
  IdealView view{IdealCamera(lens), {}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    view.pixels[i] = view.camera.ideal_pixel(lens, corners[i]);
  }
  return view;
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
    squares +=
        (view.camera.project(camera_from_corners * corners[i]) - view.pixels[i]).squaredNorm();
  }
  return std::sqrt(squares / 4);
}

/// Levenberg-Marquardt on the reprojection error. Returns the remaining error in pixels. The
/// unknowns are a rotation about the marker's centre and a shift, along the camera's axes.
double refine(const Corners& corners, const IdealView& view, RigidTransform& camera_from_corners) {
  constexpr double damping = 1e-3;
  constexpr int most_steps = 40;
  const auto linearise = [&](const RigidTransform& pose) {
    NormalEquations<double> equations;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d arm = pose.rotation * corners[i];
      const Eigen::Vector3d p = arm + pose.translation;
      const Eigen::Matrix<double, 2, 3> by_point = view.camera.derivative(p);
      Eigen::Matrix<double, 2, 6> jacobian;
      jacobian << by_point * derivative_by_rotation(arm), by_point;
      equations.add<2>(jacobian, view.pixels[i] - view.camera.project(p));
    }
    return equations;
  };
  const auto move = [](const RigidTransform& pose, const Motion& change) {
    return RigidTransform{rotation_by(change.head<3>()) * pose.rotation,
                          pose.translation + change.tail<3>()};
  };
  const auto error = [&](const RigidTransform& pose) {
    return reprojection_error(corners, view, pose);
  };
  return levenberg_marquardt(camera_from_corners, damping, most_steps, linearise, move, error);
}

/// The solver works on a marker frame with y down and z into the marker: an upright marker that
/// faces the camera is then not turned at all.
const RigidTransform solver_from_marker{Eigen::Vector3d(1, -1, -1).asDiagonal(),
                                        Eigen::Vector3d::Zero()};

/// camera_from_solver from the homography of the marker's plane (Zhang 2000), which is exact for
/// exact corners.
RigidTransform pose_from_homography(const IdealView& view, double size_m) {
  std::array<Eigen::Vector2d, 4> rays;
  for (std::size_t i = 0; i < 4; ++i) rays[i] = view.camera.ray(view.pixels[i]);
  const Eigen::Matrix3d homography = homography_of_unit_square(rays);
  Eigen::Matrix3d axes;
  axes.col(0) = homography.col(0) / size_m;
  axes.col(1) = homography.col(1) / size_m;
  Eigen::Vector3d center = homography * Eigen::Vector3d(0.5, 0.5, 1);
  const double scale = 2 / (axes.col(0).norm() + axes.col(1).norm());
  axes.leftCols<2>() *= scale;
  center *= scale;
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return {nearest_rotation(axes), center};
}

/// The pose that looks the same from afar: the marker's plane, mirrored about the line of sight
/// (Schweighofer & Pinz 2006).
RigidTransform mirrored(const RigidTransform& camera_from_solver) {
  // The smallest rotation that turns the line of sight into the optical axis. Without a direction
  // if the marker is straight behind the camera, where no pose is kept.
  const Eigen::Vector3d sight = camera_from_solver.translation.normalized();
  const double twice_cosine = std::sqrt(2 * (1 + sight.z()));  // of half the angle
  const double factor = 1 / twice_cosine;
  const Eigen::Matrix3d sight_from_camera =
      Eigen::Quaterniond(twice_cosine / 2, sight.y() * factor, -sight.x() * factor, 0)
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
