#pragma once

#include <vector>

#include "blend/camera_place.h"
#include "diminish/intrinsics.h"
#include "diminish/reconstruction.h"
#include "render/rasterizer.h"

namespace diminish {

namespace blending {

// How what several RGB-D cameras see becomes one picture, for every backend that blends. More than
// `most_cameras` that see part of the region are not blended: one is chosen (merge_layers).
//
// 1. Of cameras whose surfaces are apart (agreement_tolerance_m) the nearest is seen. But where one
//    camera alone sees it, and another looks past it, it must go on around there: less than
//    `least_part` of a window of `2 * window_reach + 1` pixels is a sliver, left over from an
//    object to remove or from a depth edge, and is left out.
// 2. Cameras that see the same surface are trusted by their ConfidenceGrid: a camera covers a cell
//    where it sees the nearest surface in all of the cell's pixels.
// 3. The two that are trusted most are blended, in parts like what their confidence has beyond the
//    third's: so nothing jumps where another camera becomes the second.
// 4. Their colours meet when both are the colour camera's (MappedCorrection).

/// There is a bit for each.
inline constexpr std::size_t most_cameras = 8;
inline constexpr int window_reach = 3;
inline constexpr float least_part = 0.4F;
/// What every camera's confidence has more than its grid says, so that there are weights where all
/// fade.
inline constexpr float least_confidence = 1e-3F;

}  // namespace blending

/// The pixels of the region that something is drawn in.
std::size_t count_drawn(const Layer& layer, const Rect& region);

/// Merges what several RGB-D cameras show into one picture. Where two surfaces agree within
/// `agreement_m` they are one, and the camera that sees more of the region is taken: a choice that
/// is the same all over a surface, so that noise does not make it speckle. Otherwise the nearer
/// surface hides the other.
/// layers: one per RGB-D camera; null for those that take no part.
void merge_layers(const std::vector<const Layer*>& layers, float agreement_m,
                  Reconstruction& reconstruction);

/// A camera that takes part in blending.
struct BlendedLayer {
  Layer* layer;  ///< its slivers are taken out of it
  CameraPlace place;
  std::uint8_t source;  ///< its name in Reconstruction::source
};

/// Blends them instead, by the rules above: the plain version. `reconstruction.second` has the
/// picture's size.
void blend_layers(const std::vector<BlendedLayer>& layers, const Intrinsics& color,
                  float agreement_m, Reconstruction& reconstruction);

}  // namespace diminish
