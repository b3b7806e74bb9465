#pragma once

#include <Eigen/Core>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/reconstruction.h"

namespace diminish {

/// A plane normal . x = distance in the colour camera's frame, the camera being on the normal's
/// side: distance < 0.
struct BackgroundPlane {
  Eigen::Vector3f normal;
  float distance_m;

  /// Positive in front of the plane.
  float height_m(const Eigen::Vector3f& point_m) const { return normal.dot(point_m) - distance_m; }
  /// 1 / z where the ray (x, y, 1) meets the plane; not positive where it does not.
  float inverse_depth(float x, float y) const {
    return (normal.x() * x + normal.y() * y + normal.z()) / distance_m;
  }
};

/// Walls, floors and tables: the planes that bound what is seen around the objects, and to which of
/// them each pixel belongs. Where nothing was measured, such a plane is the best guess of what is
/// there: it goes on behind whatever stands in front of it.
class BackgroundPlanes {
 public:
  explicit BackgroundPlanes(const Intrinsics& color);

  /// objects: where they are in the colour camera's picture. Deterministic.
  void find(const Rect& objects, const std::vector<SceneSample>& samples);
  /// Fills `reconstruction.surface`.
  void label(Reconstruction& reconstruction) const;

  const std::vector<BackgroundPlane>& planes() const { return planes_; }

 private:
  void choose_points(const Rect& objects, const std::vector<SceneSample>& samples);
  bool next_plane(BackgroundPlane& plane);
  void label_row(int y, Reconstruction& reconstruction) const;

  int columns_ = 0;
  Image<Eigen::Vector2f> rays_;  ///< of every 32nd pixel
  std::vector<Eigen::Vector3f> points_, rest_;
  std::vector<BackgroundPlane> planes_;
};

}  // namespace diminish
