#pragma once

namespace diminish {

/// A pixel's neighbours.
struct PixelOffset {
  int x, y;
};
inline constexpr PixelOffset neighbour_offsets[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};

}  // namespace diminish
