#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "depth/depth_noise.h"
#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/reconstruction.h"
#include "diminish/scene_samples.h"
#include "diminish/surfaces.h"
#include "geometry/ray_grid.h"

namespace diminish {

/// A plane normal . x = distance in the colour camera's frame. The camera is on the normal's side,
/// so distance < 0.
struct BackgroundPlane {
  Eigen::Vector3f normal;
  float distance_m;

  /// Positive in front of the plane.
  float height_m(const Eigen::Vector3f& point_m) const { return normal.dot(point_m) - distance_m; }
  /// 1 / z where the ray (x, y, 1) meets the plane; 0 or negative where it does not.
  float inverse_depth(float x, float y) const {
    return (normal.x() * x + normal.y() * y + normal.z()) / distance_m;
  }
};

/// Points, coordinate by coordinate, with their error bounds.
class PlanePoints {
 public:
  std::vector<float> x_m, y_m, z_m, tolerance_m;

  std::size_t size() const { return x_m.size(); }
  Eigen::Vector3f operator[](std::size_t i) const { return {x_m[i], y_m[i], z_m[i]}; }
  /// In front of the plane.
  float height_m(const BackgroundPlane& plane, std::size_t i) const {
    const Eigen::Vector3f& normal = plane.normal;
    return normal.x() * x_m[i] + normal.y() * y_m[i] + normal.z() * z_m[i] - plane.distance_m;
  }
  void clear() { keep(0); }
  void add(const Eigen::Vector3f& point_m, float tolerance) {
    x_m.push_back(point_m.x());
    y_m.push_back(point_m.y());
    z_m.push_back(point_m.z());
    tolerance_m.push_back(tolerance);
  }
  /// Takes every stride-th point of `all`.
  void thin(const PlanePoints& all, std::size_t stride) {
    clear();
    for (std::size_t i = 0; i < all.size(); i += stride) add(all[i], all.tolerance_m[i]);
  }
  template <class Predicate>
  void erase_if(const Predicate& predicate) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      if (predicate((*this)[i], tolerance_m[i])) continue;
      x_m[kept] = x_m[i];
      y_m[kept] = y_m[i];
      z_m[kept] = z_m[i];
      tolerance_m[kept++] = tolerance_m[i];
    }
    keep(kept);
  }

 private:
  void keep(std::size_t count) {
    for (auto* values : {&x_m, &y_m, &z_m, &tolerance_m}) values->resize(count);
  }
};

/// Walls, floors and tables: the planes around the objects, and which of them each pixel belongs
/// to. Where nothing was measured, such a plane is the best guess: it continues behind whatever
/// stands in front of it.
class BackgroundPlanes {
 public:
  static constexpr std::size_t most_planes = 3;
  /// How far a measurement may be from its plane.
  static constexpr DepthNoise tolerance{0.012F, 0.006F};
  static bool lies_on(const BackgroundPlane& plane, const Eigen::Vector3f& point_m) {
    return std::abs(plane.height_m(point_m)) <= tolerance.at(point_m.z());
  }

  explicit BackgroundPlanes(const Intrinsics& color) : rays_(color) {}

  /// Finds the planes. objects: their box in the colour camera's picture. Deterministic.
  void find(const Rect& objects, const std::vector<SceneSample>& samples);
  /// Sets `surfaces.region` to the reconstruction's, and fills `surfaces.label` in it.
  void label(const Reconstruction& reconstruction, Surfaces& surfaces) const;

  const std::vector<BackgroundPlane>& planes() const { return planes_; }

 private:
  void choose_points(const Rect& objects, const std::vector<SceneSample>& samples);
  bool next_plane(BackgroundPlane& plane);
  /// Columns [first, last) of row y.
  void label_run(int first, int last, int y, const Image<float>& depth_m,
                 Image<std::uint8_t>& label) const;

  RayGrid rays_;
  PlanePoints points_, rest_, some_, some_of_rest_;
  std::vector<BackgroundPlane> planes_;
};

}  // namespace diminish
