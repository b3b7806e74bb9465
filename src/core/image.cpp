#include "diminish/image.h"

namespace diminish {
namespace {

bool any_set(const std::uint8_t* row, int count) {
  // Without a branch, so that the compiler takes many pixels at a time.
  std::uint8_t all = 0;
  for (int x = 0; x < count; ++x) all |= row[x];
  return all != 0;
}

/// The first non-zero of `count` pixels; `count` if there is none.
int first_set(const std::uint8_t* row, int count) {
  constexpr int step = 32;
  int x = 0;
  while (x + step <= count && !any_set(row + x, step)) x += step;
  while (x < count && row[x] == 0) ++x;
  return x;
}

/// The last non-zero of `count` pixels; -1 if there is none.
int last_set(const std::uint8_t* row, int count) {
  constexpr int step = 32;
  int end = count;
  while (end >= step && !any_set(row + end - step, step)) end -= step;
  while (end > 0 && row[end - 1] == 0) --end;
  return end - 1;
}

}  // namespace

Rect bounding_box(const Mask& mask) {
  return bounding_box(mask, mask.bounds());
}

Rect bounding_box(const Mask& mask, const Rect& part) {
  int left = part.width;
  int right = -1;
  int top = -1;
  int bottom = -1;
  for (int y = part.y; y < part.bottom(); ++y) {
    const std::uint8_t* row = mask.row(y) + part.x;
    if (!any_set(row, part.width)) continue;
    if (top < 0) top = y;
    bottom = y;
    left = std::min(left, first_set(row, left));
    right += 1 + last_set(row + right + 1, part.width - right - 1);
  }
  if (top < 0) return {};
  return {part.x + left, top, right - left + 1, bottom - top + 1};
}

std::size_t count_nonzero(const Mask& mask, const Rect& part) {
  // As many as a byte can count at a time, so that the compiler takes many pixels at a time.
  constexpr int most = 255;
  std::size_t count = 0;
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int begin = part.x; begin < part.right(); begin += most) {
      const std::uint8_t* const row = mask.row(y);
      const int end = std::min(begin + most, part.right());
      std::uint8_t in_bytes = 0;
      for (int x = begin; x < end; ++x) {
        in_bytes = static_cast<std::uint8_t>(in_bytes + (row[x] != 0 ? 1 : 0));
      }
      count += in_bytes;
    }
  }
  return count;
}

}  // namespace diminish
