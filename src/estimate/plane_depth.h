#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// A plane that does not go through the camera: all points x of the camera's frame with
/// `inverse` . x = 1, so that the inverse depth along a ray (x, y, 1) is `inverse` . ray.
struct InversePlane {
  Eigen::Vector3d inverse = Eigen::Vector3d::Zero();  ///< 1/m
  /// Where a convex part of the plane ends, in order; none: nowhere.
  std::vector<Eigen::Vector3d> corners = {};

  /// Through a point, with this normal.
  static InversePlane through(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
    return {normal / normal.dot(point), {}};
  }
  double inverse_depth(const Eigen::Vector2d& ray) const {
    return inverse.x() * ray.x() + inverse.y() * ray.y() + inverse.z();
  }
  /// The normal, to the inside, of the plane through the camera and the part's i-th side.
  Eigen::Vector3d inward(std::size_t i) const;
  /// Whether a ray (x, y, 1) that meets the plane does so in its part.
  bool is_met_by(const Eigen::Vector2d& ray) const;
  bool is_finite() const { return inverse.allFinite() && inverse.norm() > 1e-4; }
};

/// The plane in another camera's frame.
inline InversePlane transformed(const InversePlane& plane, const RigidTransform& from_other) {
  InversePlane there{from_other.rotation.transpose() * plane.inverse /
                         (1 - plane.inverse.dot(from_other.translation)),
                     plane.corners};
  const RigidTransform other_from = from_other.inverse();
  for (Eigen::Vector3d& corner : there.corners) corner = other_from * corner;
  return there;
}

/// The nearest plane's inverse depth (1/m) along a ray (x, y, 1); 0 if there is none.
double nearest_inverse_depth(std::span<const InversePlane> planes, const Eigen::Vector2d& ray);

/// Whether any pixel of the camera shows the plane where nothing is in front of it, nearer than
/// what a depth image can hold. view: a camera without lens distortion.
bool is_in_view(const InversePlane& plane, const Intrinsics& view, double depth_unit_m);

/// Writes how far away the nearest plane is along each pixel's ray; 0 where there is none. view: a
/// camera without lens distortion. depth: of its size. Cost: 1 ns per pixel and plane, shared by
/// threads.
void draw_planes(const std::vector<InversePlane>& planes, const Intrinsics& view,
                 double depth_unit_m, Image<std::uint16_t>& depth);

}  // namespace diminish
