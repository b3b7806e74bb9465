#pragma once

#include <algorithm>

#include "diminish/image.h"

namespace diminish {

/// The mean of the colours around a pixel, and whether they are alike.
struct EvenColor {
  float channels[3] = {};
  bool even = false;
};

inline constexpr int even_color_reach_px = 2;

/// From nine pixels up to `even_color_reach_px` away, which must all be in the image.
inline EvenColor even_color(ImageView<Bgr> image, int x, int y) {
  constexpr int largest_range = 24;
  int sum[3] = {};
  int lowest[3] = {255, 255, 255};
  int highest[3] = {};
  for (int dy = -even_color_reach_px; dy <= even_color_reach_px; dy += even_color_reach_px) {
    const Bgr* row = image.row(y + dy) + x;
    for (int dx = -even_color_reach_px; dx <= even_color_reach_px; dx += even_color_reach_px) {
      const int levels[3] = {row[dx].b, row[dx].g, row[dx].r};
      for (int c = 0; c < 3; ++c) {
        sum[c] += levels[c];
        lowest[c] = std::min(lowest[c], levels[c]);
        highest[c] = std::max(highest[c], levels[c]);
      }
    }
  }
  EvenColor result;
  result.even = true;
  for (int c = 0; c < 3; ++c) {
    result.channels[c] = static_cast<float>(sum[c]) / 9.F;
    result.even = result.even && highest[c] - lowest[c] <= largest_range;
  }
  return result;
}

}  // namespace diminish
