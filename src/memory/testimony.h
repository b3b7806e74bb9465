#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>

#include "depth/depth_noise.h"
#include "diminish/frame_set.h"
#include "diminish/rig.h"
#include "diminish/rigid_transform.h"
#include "geometry/projection.h"
#include "geometry/ray_table.h"

namespace diminish {

/// What an RGB-D camera saw at one moment, apart from the objects to remove, at some pixels of its
/// depth image.
struct Testimony {
  bool is_given = false;  ///< it had images and a pose
  RigidTransform depth_from_world;
  Image<float> depth_m;  ///< 0: not measured, or on an object
  Image<Bgr> color;      ///< of its colour sensor at these points; only where there is depth
};

/// The places of a camera's testimonies: every `step`-th pixel of its depth image, row by row.
class TestimonyGrid {
 public:
  /// Places along a row are fewer.
  static constexpr int most_columns = 256;

  explicit TestimonyGrid(const Intrinsics& depth);

  int step() const { return step_; }
  const Rect& bounds() const { return bounds_; }
  /// Its pixels are the places.
  const Projection& lens() const { return lens_; }
  const RayTable& rays() const { return *rays_; }

 private:
  int step_;
  Rect bounds_;
  Projection lens_;
  std::shared_ptr<const RayTable> rays_;
};

/// Takes one RGB-D camera's testimonies.
class TestimonyTaker {
 public:
  explicit TestimonyTaker(const RgbdCamera& camera);

  /// masks: this camera's. Cost: 15 ns a place.
  void take(const RgbdFrame& images, const std::optional<RigidTransform>& depth_from_world,
            const Mask& depth_mask, const Mask& color_mask, Testimony& testimony) const;

  const TestimonyGrid& grid() const { return grid_; }

 private:
  TestimonyGrid grid_;
  float unit_m_;
  Projection color_;
  FloatTransform color_from_depth_;
};

}  // namespace diminish
