#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "diminish/rigid_transform.h"

namespace diminish {

/// A marker seen in an image. corners: the outer corners of the black square, clockwise from the
/// marker's top left, in pixels of the (distorted) image.
struct Marker {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners;
};

/// The markers seen in each colour image of a frame.
struct Markers {
  std::vector<Marker> color;
  std::vector<std::vector<Marker>> rgbd;  ///< one list per RGB-D camera
};

/// The cameras' poses in this frame. Unknown ones are absent; poses of earlier frames are never
/// used.
struct Poses {
  std::optional<RigidTransform> color_from_world;
  std::vector<std::optional<RigidTransform>> depth_from_world;  ///< one per RGB-D camera
  /// From each RGB-D camera's depth sensor to the (user's) colour camera. Drawing needs these.
  std::vector<std::optional<RigidTransform>> color_from_depth;
  /// What is missing, in plain words: "world marker 0 not visible in rgbd0".
  std::vector<std::string> messages;
};

}  // namespace diminish
