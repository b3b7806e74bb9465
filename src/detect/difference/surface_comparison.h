#pragma once

#include "detect/difference/seen_layers.h"
#include "diminish/image.h"

namespace diminish {

/// How far a pixel of the picture is from the colours of the nearest and of the farthest surface
/// on its line of sight, in levels: from all colours in the pixel's neighbourhood. 0 where no
/// RGB-D camera sees anything.
struct SurfaceDifference {
  float nearest = 0, farthest = 0;
  float either = 0;  ///< the lesser one
};

/// Relative distance of two layers from which on they are two surfaces.
inline constexpr float two_surfaces = 0.03F;

/// By which share a line of sight is shorter to the nearest surface than to the farthest.
inline float gap(const SeenSurface& nearest, const SeenSurface& farthest) {
  return 1 - nearest.depth_m / farthest.depth_m;
}

/// How far a colour is from a neighbourhood's, given the least and the greatest of each channel.
float color_difference(const Bgr& color, const Bgr& least, const Bgr& greatest);

/// The pixels of a row. Cost: 1 ns each.
void compare_surfaces(const SeenSurface* nearest, const SeenSurface* farthest, const Bgr* least,
                      const Bgr* greatest, int count, SurfaceDifference* differences);

}  // namespace diminish
