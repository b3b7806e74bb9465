#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace diminish {

/// The rotation about an axis by its length, in radians.
inline Eigen::Matrix3d rotation_by(const Eigen::Vector3d& axis_times_angle) {
  const double angle = axis_times_angle.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, axis_times_angle / angle).toRotationMatrix();
}

/// The rotation nearest to a matrix, in the sense of least squares: by its singular value
/// decomposition. A reflection for a matrix with a negative determinant.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

}  // namespace diminish
