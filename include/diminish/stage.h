#pragma once

#include <array>
#include <cstddef>

namespace diminish {

/// The stages of a frame, in their order (src/pipeline/pipeline.cpp).
enum class Stage {
  poses,        ///< markers; where the cameras are
  objects,      ///< masks of the objects to remove, in every image
  depth,        ///< depth images cleaned, where they may be drawn
  samples,      ///< thin samples of the scene
  refinement,   ///< of the colour camera's pose
  background,   ///< its planes, and the shadows that the objects cast on them
  color_maps,   ///< how the cameras' colours relate
  drawing,      ///< the scene from the colour camera's viewpoint
  compositing,  ///< which pixels were seen, which plane and how much light each shows
  colors,       ///< what was seen, in the colour camera's colours and without shadows
  inpainting,   ///< what was not seen
  finish        ///< noise, rims, view mode
};
inline constexpr std::size_t stage_count = 12;
inline constexpr std::array<const char*, stage_count> stage_names = {
    "poses",      "objects", "depth",       "samples", "refinement", "background",
    "color_maps", "drawing", "compositing", "colors",  "inpainting", "finish"};

/// Milliseconds by Stage. `depth` runs beside the four stages after it, so that the sum may exceed
/// the frame's time.
using StageTimes = std::array<double, stage_count>;

}  // namespace diminish
