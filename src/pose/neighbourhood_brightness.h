#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "core/shrunk_picture.h"
#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// The mean brightness of 5x5 pixels of an image, `spacing_px` apart, around (u, v). Less than 0
/// where they are not all in the image.
inline float neighbourhood_brightness(ImageView<Bgr> image, float u, float v, int spacing_px) {
  constexpr int reach = 2;
  const int rim = reach * spacing_px;
  const int x = static_cast<int>(std::lrint(u));
  const int y = static_cast<int>(std::lrint(v));
  if (x < rim || y < rim || x >= image.width() - rim || y >= image.height() - rim) return -1;
  int blue = 0;
  int green = 0;
  int red = 0;
  for (int j = -reach; j <= reach; ++j) {
    const Bgr* const row = image.row(y + j * spacing_px);
    for (int k = -reach; k <= reach; ++k) {
      const Bgr& color = row[x + k * spacing_px];
      blue += color.b;
      green += color.g;
      red += color.r;
    }
  }
  constexpr float taps = (2 * reach + 1) * (2 * reach + 1);
  return brightness(blue, green, red) / taps;
}

}  // namespace diminish
