#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "diminish/export.h"

namespace diminish {

/// A rigid transform between two frames, named `a_from_b`: it takes a point's coordinates in frame
/// b to its coordinates in frame a, `x_a = rotation * x_b + translation`. Metres.
struct RigidTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x_in_b) const {
    return rotation * x_in_b + translation;
  }
  /// `a_from_b * b_from_c == a_from_c`.
  RigidTransform operator*(const RigidTransform& b_from_c) const {
    return {rotation * b_from_c.rotation, rotation * b_from_c.translation + translation};
  }
  /// `b_from_a`.
  RigidTransform inverse() const {
    return {rotation.transpose(), -(rotation.transpose() * translation)};
  }
};

/// The angle of the rotation between two orientations, in degrees.
DIMINISH_EXPORT double rotation_difference_deg(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

}  // namespace diminish
