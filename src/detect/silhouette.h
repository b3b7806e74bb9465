#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// Drawing of projected shapes. A pixel is set to 255 when its centre lies inside the shape as the
/// lens pictures it, distortion included, to better than 0.1 px; the others are left alone. What is
/// closer than 1 cm to the camera's plane or behind it is cut off. Points are in the camera's
/// frame, metres, finite; `mask` has the lens's size. Both return whether the shape covers a pixel.

/// The convex hull of `points_in_camera`, which may be flat.
bool fill_convex_hull(const std::vector<Eigen::Vector3d>& points_in_camera, const Lens& lens,
                      Mask& mask);

/// The union of triangles, given by indices into `vertices_in_camera`.
bool fill_triangles(const std::vector<Eigen::Vector3d>& vertices_in_camera,
                    const std::vector<std::array<int, 3>>& triangles, const Lens& lens, Mask& mask);

}  // namespace diminish
