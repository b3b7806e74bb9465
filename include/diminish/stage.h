#pragma once

#include <array>
#include <cstddef>

namespace diminish {

/// The stages of a frame, in order (src/pipeline/pipeline.cpp).
enum class Stage {
  poses,        ///< markers; where the cameras are
  objects,      ///< masks of the objects to remove, in every image
  depth,        ///< cleans the parts of depth images that may be drawn
  samples,      ///< sparse samples of the scene
  refinement,   ///< refines the colour camera's pose
  background,   ///< planes, and the shadows that the objects cast on them
  color_maps,   ///< how the cameras' colours relate
  drawing,      ///< the scene from the colour camera's viewpoint
  memory,       ///< what was seen earlier
  compositing,  ///< which pixels were seen, and the plane and light of each
  colors,       ///< seen pixels in the colour camera's colours, without shadows
  inpainting,   ///< pixels that were not seen
  finish        ///< noise, rims, view mode
};
inline constexpr std::size_t stage_count = 13;
inline constexpr std::array<const char*, stage_count> stage_names = {
    "poses",   "objects", "depth",       "samples", "refinement", "background", "color_maps",
    "drawing", "memory",  "compositing", "colors",  "inpainting", "finish"};

/// Milliseconds by Stage. `depth` runs at the same time as the four stages after it, so the sum may
/// exceed the frame's time.
using StageTimes = std::array<double, stage_count>;

}  // namespace diminish
