#pragma once

#include <Eigen/Core>
#include <span>

#include "core/rows.h"
#include "diminish/image.h"
#include "diminish/surfaces.h"
#include "geometry/ray_grid.h"
#include "scene/cast_shadows.h"

namespace diminish {

/// The shadows that the objects to remove cast on things that stand in front of the planes.
///
/// A plane's shadow tells how much of its light comes from each direction (CastShadows). A thing
/// near it gets the same light, as far as its surface faces it:
///
///   light(p) = 1 - a sum of  share_d f_d(p) hidden_d(p)  /  (1 - sum of  share_d (1 - f_d(p))),
///
/// where f_d is 1 on the plane, less where the surface turns away from d, and 0 where it faces
/// away: nothing that is hidden from there changes it. The surface's direction is that of the
/// measured depth. a is less than 1: things also get light from the plane.
class ThingLight {
 public:
  /// Light and directions are found for blocks of so many pixels a side.
  static constexpr int block_px = 8;

  /// Lowers `surfaces.light` where the label is `foreground`. Cost: 6 million instructions
  /// for the calendar.
  void shade(std::span<const CastShadow> shadows, const RayGrid& rays, const Image<float>& depth_m,
             Surfaces& surfaces);

 private:
  /// Blue, green, red, and how much is known.
  using Levels = Eigen::Array4f;

  void find_depths(const Image<float>& depth_m, const Surfaces& surfaces);
  bool find_light(std::span<const CastShadow> shadows, const RayGrid& rays, const Rect& region);
  void smooth();
  void apply(Surfaces& surfaces) const;

  /// By block. 0: no thing.
  Image<float> inverse_depth_;
  Image<Levels> light_, smooth_;
};

}  // namespace diminish
