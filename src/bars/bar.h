#pragma once

#include <Eigen/Core>

#include "diminish/image.h"
#include "geometry/point_projection.h"
#include "scene/background_planes.h"

namespace diminish {

/// A straight bar, such as a steel pipe, that runs into the objects' mask in front of a plane. In
/// pixels of the colour camera's picture.
struct Bar {
  Eigen::Vector2f entry = Eigen::Vector2f::Zero();    ///< its middle, where it enters the mask
  Eigen::Vector2f inward = Eigen::Vector2f::UnitX();  ///< unit vector along it, into the mask
  float width_px = 0;
  BackgroundPlane plane{Eigen::Vector3f::UnitZ(),
                        0};  ///< parallel to what is behind it, through the bar
  bool goes_on = false;      ///< it is seen beyond the mask, too
  float score = 0;

  Eigen::Vector2f across() const { return {-inward.y(), inward.x()}; }
  /// along: from the entry, into the mask. side: from its middle.
  Eigen::Vector2f at(float along, float side) const {
    return entry + along * inward + side * across();
  }
  float along(const Eigen::Vector2f& at) const { return inward.dot(at - entry); }
  float side(const Eigen::Vector2f& at) const { return across().dot(at - entry); }
};

/// Whether an object hides the place in the user's picture.
inline bool is_hidden(const Mask& occlusion, const Eigen::Vector2f& at) {
  const auto [x, y] = nearest_pixel(at);
  return occlusion.bounds().contains(x, y) && occlusion(x, y) != 0;
}

}  // namespace diminish
