#pragma once

#include <vector>

#include "blend/camera_place.h"
#include "diminish/intrinsics.h"
#include "diminish/reconstruction.h"
#include "render/rasterizer.h"

namespace diminish {

namespace blending {

// How the views of several RGB-D cameras become one picture, for every backend that blends. If more
// than `most_cameras` see part of the region, one is chosen instead (merge_layers).
//
// 1. Where surfaces differ (agreement_tolerance_m), the nearest is seen. But where only one
//    camera sees it and another looks past it, it must continue around the pixel: less than
//    `least_part` of a window of `2 * window_reach + 1` pixels is a sliver left over from an
//    object to remove or from a depth edge. Slivers are removed.
// 2. Cameras that see the same surface are trusted by their ConfidenceGrid: a camera covers a cell
//    if it sees the nearest surface in all of the cell's pixels.
// 3. The two most trusted cameras are blended, in proportion to their confidence minus the
//    third's. So nothing jumps where another camera becomes the second.
// 4. Their colours are mixed after both are mapped to the colour camera's (MappedCorrection).

/// One bit for each.
inline constexpr std::size_t most_cameras = 8;
inline constexpr int window_reach = 3;
inline constexpr float least_part = 0.4F;
/// Added to every camera's confidence, so that there are weights where all fade.
inline constexpr float least_confidence = 1e-3F;

}  // namespace blending

/// The number of pixels of the region that are drawn.
std::size_t count_drawn(const Layer& layer, const Rect& region);

/// Merges the views of several RGB-D cameras into one picture. Where two surfaces agree within
/// `agreement_m` they are one, and the camera that sees more of the region is taken. That choice is
/// the same all over a surface, so noise does not make it speckle. Otherwise the nearer surface
/// hides the other.
/// layers: one per RGB-D camera; null for those that take no part.
void merge_layers(const std::vector<const Layer*>& layers, float agreement_m,
                  Reconstruction& reconstruction);

/// A camera that takes part in blending.
struct BlendedLayer {
  Layer* layer;  ///< its slivers are removed
  CameraPlace place;
  std::uint8_t source;  ///< its name in Reconstruction::source
};

/// Blends them by the rules above: the plain version. `reconstruction.second` has the picture's
/// size.
void blend_layers(const std::vector<BlendedLayer>& layers, const Intrinsics& color,
                  float agreement_m, Reconstruction& reconstruction);

}  // namespace diminish
