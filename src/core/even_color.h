#pragma once

#include "diminish/image.h"

namespace diminish {

/// The mean of the colours around a pixel, and whether they are alike.
struct EvenColor {
  float channels[3] = {};
  bool even = false;
};

inline constexpr int even_color_reach_px = 2;
/// The most that a channel of even colours may vary.
inline constexpr int even_color_range = 24;

/// From nine pixels up to `even_color_reach_px` away, which must all be in the image. On vector
/// instructions.
EvenColor even_color(ImageView<Bgr> image, int x, int y);

namespace plain {
/// The same, bit for bit.
EvenColor even_color(ImageView<Bgr> image, int x, int y);
}  // namespace plain

}  // namespace diminish
