#include "detect/place_deviation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pose/marker_pose.h"

namespace diminish {
namespace {

using Jacobian = Eigen::Matrix<double, 2, 6>;

/// Of a point's pixel by the pose: rotations about the camera's axes at the marker's middle, and
/// shifts. Without the lens's distortion, which hardly changes from point to point.
Jacobian pixel_by_pose(const RigidTransform& camera_from_marker, const Lens& lens,
                       const Eigen::Vector3d& point_m) {
  const Eigen::Vector3d arm = camera_from_marker.rotation * point_m;
  const Eigen::Vector3d place = arm + camera_from_marker.translation;
  const Intrinsics& camera = lens.intrinsics();
  Eigen::Matrix<double, 2, 3> by_place;
  by_place << camera.fx, 0, -camera.fx * place.x() / place.z(),  //
      0, camera.fy, -camera.fy * place.y() / place.z();
  by_place /= place.z();
  Eigen::Matrix3d by_rotation;
  by_rotation << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
  Jacobian jacobian;
  jacobian << by_place * by_rotation, by_place;
  return jacobian;
}

}  // namespace

double place_deviation_px(const RigidTransform& camera_from_marker, double size_m, const Lens& lens,
                          double corner_deviation_px,
                          const std::vector<Eigen::Vector3d>& points_m) {
  constexpr double nearest_m = 0.01;
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  for (const Eigen::Vector3d& corner : marker_corners(size_m)) {
    const Jacobian jacobian = pixel_by_pose(camera_from_marker, lens, corner);
    information += jacobian.transpose() * jacobian;
  }
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(information);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  double most = 0;
  for (const Eigen::Vector3d& point : points_m) {
    if ((camera_from_marker * point).z() < nearest_m) continue;
    const Jacobian jacobian = pixel_by_pose(camera_from_marker, lens, point);
    const Eigen::Matrix2d covariance = jacobian * factor.solve(jacobian.transpose());
    // The larger eigenvalue.
    const double mean = covariance.trace() / 2;
    const double spread = std::hypot((covariance(0, 0) - covariance(1, 1)) / 2, covariance(0, 1));
    most = std::max(most, mean + spread);
  }
  return corner_deviation_px * std::sqrt(most);
}

}  // namespace diminish
