#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "depth/depth_noise.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// Where an RGB-D camera is, in the colour camera's frame.
struct CameraPlace {
  Eigen::Vector3f eye_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f forward = Eigen::Vector3f::UnitZ();  ///< its depth sensor's z axis

  CameraPlace() = default;
  explicit CameraPlace(const RigidTransform& color_from_depth)
      : eye_m(color_from_depth.translation.cast<float>()),
        forward(color_from_depth.rotation.col(2).cast<float>()) {}

  /// z in the depth sensor's frame.
  float depth_m(const Eigen::Vector3f& point_m) const { return forward.dot(point_m - eye_m); }
};

/// The ray of a colour pixel with z = 1. Ignores lens distortion: weights and tolerances do not
/// need it.
inline Eigen::Vector3f pinhole_ray(const Intrinsics& color, float x, float y) {
  return {(x - static_cast<float>(color.cx)) / static_cast<float>(color.fx),
          (y - static_cast<float>(color.cy)) / static_cast<float>(color.fy), 1.F};
}

/// Two cameras' surfaces closer than this are one surface: `agreement_m`, or the noise of both
/// where that is more. noise_m: each camera's noise, at the surface's depth in its own frame.
inline float agreement_tolerance_m(float agreement_m, float noise_a_m, float noise_b_m) {
  return std::max(agreement_m, noise_a_m + noise_b_m);
}

}  // namespace diminish
