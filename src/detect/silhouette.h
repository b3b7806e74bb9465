#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// Draws projected shapes as one lens pictures them. A pixel is set to 255 when its centre lies
/// inside the shape's picture, distortion included, to better than 0.1 px; the others are left
/// alone. What is closer than 1 cm to the camera's plane or behind it is cut off. Points are in the
/// camera's frame, metres, finite; `mask` has the lens's size. Functions return whether the shape
/// covers a pixel.
class SilhouetteDrawer {
 public:
  explicit SilhouetteDrawer(const Lens& lens);
  ~SilhouetteDrawer();
  SilhouetteDrawer(SilhouetteDrawer&&) noexcept;
  SilhouetteDrawer& operator=(SilhouetteDrawer&&) noexcept;

  /// The convex hull of `points_in_camera`, which may be flat.
  bool fill_convex_hull(const std::vector<Eigen::Vector3d>& points_in_camera, Mask& mask);

  /// The union of triangles, given by indices into `vertices_in_camera`.
  bool fill_triangles(const std::vector<Eigen::Vector3d>& vertices_in_camera,
                      const std::vector<std::array<int, 3>>& triangles, Mask& mask);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
