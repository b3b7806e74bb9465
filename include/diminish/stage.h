#pragma once

#include <array>
#include <cstddef>

namespace diminish {

/// The stages of a frame, in order (src/pipeline/pipeline.cpp).
enum class Stage {
  poses,        ///< markers; where the cameras are
  objects,      ///< masks of the objects to remove, in every image
  estimation,   ///< depth images of cameras that measure none
  depth,        ///< cleans the parts of depth images that may be drawn
  samples,      ///< sparse samples of the scene
  refinement,   ///< refines the colour camera's pose
  background,   ///< planes, and the shadows that the objects cast on them
  color_maps,   ///< how the cameras' colours relate
  memory,       ///< what was seen earlier, from the colour camera's viewpoint
  drawing,      ///< the scene as it is seen now
  merging,      ///< shows what was seen earlier where that is better
  compositing,  ///< which pixels were seen, and the plane and light of each
  colors,       ///< seen pixels in the colour camera's colours, without shadows
  inpainting,   ///< pixels that were not seen
  finish        ///< noise, rims, view mode
};
inline constexpr std::size_t stage_count = 15;
inline constexpr std::array<const char*, stage_count> stage_names = {
    "poses",      "objects",     "estimation", "depth",      "samples",
    "refinement", "background",  "color_maps", "memory",     "drawing",
    "merging",    "compositing", "colors",     "inpainting", "finish"};

/// Milliseconds by Stage. Some stages run at the same time, so the sum may exceed the frame's time:
/// `depth` to `refinement`; `background` to `drawing`.
using StageTimes = std::array<double, stage_count>;

}  // namespace diminish
