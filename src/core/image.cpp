#include "diminish/image.h"

#include <cstring>

#include "core/runs.h"

namespace diminish {
namespace {

bool any_set(const std::uint8_t* row, int count) {
  // Without a branch, so that the compiler vectorises it.
  std::uint64_t any = 0;
  int x = 0;
  for (; x + 8 <= count; x += 8) {
    std::uint64_t pixels;
    std::memcpy(&pixels, row + x, sizeof(pixels));
    any |= pixels;
  }
  for (; x < count; ++x) any |= row[x];
  return any != 0;
}

/// The last non-zero of `count` pixels; -1 if there is none.
int last_set(const std::uint8_t* row, int count) {
  constexpr int step = 32;
  int end = count;
  while (end >= step && !any_set(row + end - step, step)) end -= step;
  while (end > 0 && row[end - 1] == 0) --end;
  return end - 1;
}

/// As many as a byte can count at a time, so that the compiler takes many pixels at a time.
template <class Predicate>
std::size_t count_if(const Image<std::uint8_t>& image, const Rect& part,
                     const Predicate& predicate) {
  constexpr int most = 255;
  std::size_t count = 0;
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int begin = part.x; begin < part.right(); begin += most) {
      const std::uint8_t* const row = image.row(y);
      const int end = std::min(begin + most, part.right());
      std::uint8_t in_bytes = 0;
      for (int x = begin; x < end; ++x) {
        in_bytes = static_cast<std::uint8_t>(in_bytes + (predicate(row[x]) ? 1 : 0));
      }
      count += in_bytes;
    }
  }
  return count;
}

}  // namespace

Rect bounding_box(const Mask& mask) {
  return bounding_box(mask, mask.bounds());
}

Rect bounding_box(const Mask& mask, const Rect& part) {
  int left = part.width;
  int right = -1;
  const auto is_empty = [&](int y) { return !any_set(mask.row(y) + part.x, part.width); };
  int top = part.y;
  int bottom = part.bottom() - 1;
  while (top <= bottom && is_empty(top)) ++top;
  while (bottom > top && is_empty(bottom)) --bottom;
  for (int y = top; y <= bottom; ++y) {
    const std::uint8_t* row = mask.row(y) + part.x;
    left = find_other(row, 0, left, 0);
    right += 1 + last_set(row + right + 1, part.width - right - 1);
  }
  if (top > bottom) return {};
  return {part.x + left, top, right - left + 1, bottom - top + 1};
}

std::size_t count_equal(const Image<std::uint8_t>& image, std::uint8_t value, const Rect& part) {
  return count_if(image, part, [value](std::uint8_t pixel) { return pixel == value; });
}

std::size_t count_nonzero(const Mask& mask, const Rect& part) {
  return count_if(mask, part, [](std::uint8_t pixel) { return pixel != 0; });
}

}  // namespace diminish
