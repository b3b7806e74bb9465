#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "detect/silhouette/polygon_filler.h"
#include "detect/silhouette/polygons.h"
#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// Outlines projected shapes as one lens pictures them, including distortion, to better than 0.1
/// px. Cuts off everything less than 1 cm in front of the camera's plane, behind it, or far outside
/// the picture. Points are in the camera's frame, metres, finite.
class Silhouette {
 public:
  explicit Silhouette(const Lens& lens);
  ~Silhouette();
  Silhouette(Silhouette&&) noexcept;
  Silhouette& operator=(Silhouette&&) noexcept;

  /// Adds the convex hull of `points_in_camera`, which may be flat, as part of an object.
  void outline_convex_hull(const std::vector<Eigen::Vector3d>& points_in_camera,
                           std::uint32_t object, Polygons& polygons);

  /// Adds triangles, given by indices into `vertices_in_camera`.
  void outline_triangles(const std::vector<Eigen::Vector3d>& vertices_in_camera,
                         const std::vector<std::array<int, 3>>& triangles, std::uint32_t object,
                         Polygons& polygons);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Draws silhouettes directly: sets their pixels to 255 and leaves the others alone. `mask` has the
/// lens's size. Functions return whether the shape covers a pixel.
class SilhouetteDrawer {
 public:
  explicit SilhouetteDrawer(const Lens& lens) : silhouette_(lens) {}

  bool fill_convex_hull(const std::vector<Eigen::Vector3d>& points_in_camera, Mask& mask);
  /// The union of triangles.
  bool fill_triangles(const std::vector<Eigen::Vector3d>& vertices_in_camera,
                      const std::vector<std::array<int, 3>>& triangles, Mask& mask);

 private:
  bool fill(Mask& mask);

  Silhouette silhouette_;
  Polygons polygons_;
  PolygonFiller filler_;
};

}  // namespace diminish
