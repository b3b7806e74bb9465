#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// A plane that does not go through the camera: all points x of the camera's frame with
/// `inverse` . x = 1, so that the inverse depth along a ray (x, y, 1) is `inverse` . ray.
struct InversePlane {
  Eigen::Vector3d inverse = Eigen::Vector3d::Zero();  ///< 1/m

  /// Through a point, with this normal.
  static InversePlane through(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
    return {normal / normal.dot(point)};
  }
  double inverse_depth(const Eigen::Vector2d& ray) const {
    return inverse.x() * ray.x() + inverse.y() * ray.y() + inverse.z();
  }
  bool is_finite() const { return inverse.allFinite() && inverse.norm() > 1e-4; }
};

/// The plane in another camera's frame.
inline InversePlane transformed(const InversePlane& plane, const RigidTransform& from_other) {
  return {from_other.rotation.transpose() * plane.inverse /
          (1 - plane.inverse.dot(from_other.translation))};
}

/// More are not drawn.
inline constexpr std::size_t most_planes = 16;

/// Writes how far away the nearest plane is along each pixel's ray; 0 where there is none. view: a
/// camera without lens distortion. depth: of its size. Cost: 1 ns per pixel and plane, shared by
/// threads.
void draw_planes(const std::vector<InversePlane>& planes, const Intrinsics& view,
                 double depth_unit_m, Image<std::uint16_t>& depth);

}  // namespace diminish
