#pragma once

#include "diminish/image.h"

// What the view modes look like, on the processor and on the GPU.

namespace diminish::xray {
/// Differences of brightness from one pixel to the next but one, levels, that make a full line.
inline constexpr float full_difference = 60;
/// The share of a full line below which there is none, and the line's share of the picture.
inline constexpr float least_strength = 0.2F;
inline constexpr float opacity = 0.8F;
inline constexpr Bgr line_color{255, 255, 255};
}  // namespace diminish::xray

namespace diminish::outline {
inline constexpr int width_px = 2;
inline constexpr Bgr line_color{0, 220, 255};
}  // namespace diminish::outline

namespace diminish::provenance_view {
inline constexpr float tint = 0.35F;
inline constexpr Bgr seen_color{0, 200, 0};
inline constexpr Bgr invented_color{255, 0, 255};
/// Of the hatching, along rows.
inline constexpr int period_px = 8;
inline constexpr int line_px = 2;
}  // namespace diminish::provenance_view
