#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "geometry/projection.h"

namespace diminish {

/// A camera sees nothing nearer than this, metres.
inline constexpr float nearest_seen_m = 0.05F;
/// No pixel is further from a picture than this; distortion may say more.
inline constexpr float farthest_px = 1e6F;

inline Eigen::Vector3f transform(const FloatTransform& a_from_b, const Eigen::Vector3f& x_in_b) {
  const float x = x_in_b.x();
  const float y = x_in_b.y();
  const float z = x_in_b.z();
  return {a_from_b.apply(0, x, y, z), a_from_b.apply(1, x, y, z), a_from_b.apply(2, x, y, z)};
}

/// Where a point in the camera's frame is in its picture; nothing behind the camera or outside the
/// lens.
inline std::optional<Eigen::Vector2f> project_exactly(const Projection& lens,
                                                      const Eigen::Vector3f& point_m) {
  Eigen::Vector2f at;
  if (!(point_m.z() > nearest_seen_m) ||
      !lens.distort(point_m.x() / point_m.z(), point_m.y() / point_m.z(), at.x(), at.y()) ||
      !(std::abs(at.x()) < farthest_px && std::abs(at.y()) < farthest_px)) {
    return std::nullopt;
  }
  return at;
}

struct Pixel {
  int x, y;
};
inline Pixel nearest_pixel(const Eigen::Vector2f& at) {
  return {static_cast<int>(std::lrint(at.x())), static_cast<int>(std::lrint(at.y()))};
}
/// The pixel nearest to it.
inline std::optional<Pixel> project(const Projection& lens, const Eigen::Vector3f& point_m) {
  const auto at = project_exactly(lens, point_m);
  return at ? std::optional(nearest_pixel(*at)) : std::nullopt;
}

}  // namespace diminish
