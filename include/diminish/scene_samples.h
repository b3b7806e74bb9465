#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// A point on a surface that an RGB-D camera sees and the colour camera may see too.
struct SceneSample {
  Eigen::Vector3f point_m = Eigen::Vector3f::Zero();  ///< in the colour camera's frame
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();    ///< its place in the colour camera's image
  Eigen::Vector2f texture =
      Eigen::Vector2f::Zero();  ///< its place in the RGB-D camera's colour image
  Bgr color;                    ///< the RGB-D camera's, averaged over the neighbourhood
  std::uint8_t source = 0;      ///< 1 + the RGB-D camera's index
  bool even = false;            ///< the neighbourhood has a single colour
  std::uint32_t point = 0;      ///< of a remote camera: its place in Glance::points
};

/// Sparse samples over the whole picture of what the RGB-D cameras see.
struct SceneSamples {
  /// On surfaces, away from objects to remove and from depth edges; sorted by `source`. A few
  /// thousand.
  std::vector<SceneSample> surfaces;
  /// On the objects to remove, where RGB-D cameras see them, in the colour camera's frame.
  std::vector<Eigen::Vector3f> object_points_m;
};

}  // namespace diminish
