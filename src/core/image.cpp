#include "diminish/image.h"

namespace diminish {

Rect bounding_box(const Mask& mask) {
  int left = mask.width();
  int right = -1;
  int top = -1;
  int bottom = -1;
  for (int y = 0; y < mask.height(); ++y) {
    const std::uint8_t* row = mask.row(y);
    const std::uint8_t* end = row + mask.width();
    const auto* first = std::find_if(row, end, [](std::uint8_t value) { return value != 0; });
    if (first == end) continue;
    const std::uint8_t* last = end - 1;
    while (*last == 0) --last;
    left = std::min(left, static_cast<int>(first - row));
    right = std::max(right, static_cast<int>(last - row));
    if (top < 0) top = y;
    bottom = y;
  }
  if (top < 0) return {};
  return {left, top, right - left + 1, bottom - top + 1};
}

std::size_t count_nonzero(const Mask& mask, const Rect& part) {
  std::size_t count = 0;
  for (int y = part.y; y < part.bottom(); ++y) {
    const std::uint8_t* row = mask.row(y);
    for (int x = part.x; x < part.right(); ++x) count += row[x] != 0;
  }
  return count;
}

}  // namespace diminish
