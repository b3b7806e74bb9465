#pragma once

#include "diminish/image.h"

// How the view modes look, on the CPU and on the GPU.

namespace diminish::xray {
/// The difference of brightness between a pixel's two neighbours, in levels, that gives a full
/// line.
inline constexpr float full_difference = 60;
/// The share of a full line below which there is no line, and the line's share of the picture.
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
inline constexpr Bgr witnessed_color{190, 220, 120};
inline constexpr Bgr remembered_color{60, 200, 250};
inline constexpr Bgr estimated_color{220, 150, 150};
inline constexpr Bgr invented_color{255, 0, 255};
/// The period of the hatching, along rows.
inline constexpr int period_px = 8;
inline constexpr int line_px = 2;
}  // namespace diminish::provenance_view
