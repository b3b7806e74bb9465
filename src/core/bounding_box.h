#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/runs.h"
#include "diminish/image.h"

namespace diminish {

/// Whether any of `count` pixels of a mask is set.
inline bool any_set(const std::uint8_t* row, int count) {
  // Without a branch, so that the compiler vectorises it.
  constexpr int words = 8;
  std::uint64_t any[words] = {};
  int x = 0;
  for (; x + 8 * words <= count; x += 8 * words) {
    for (int i = 0; i < words; ++i) {
      std::uint64_t pixels;
      std::memcpy(&pixels, row + x + std::ptrdiff_t{8} * i, sizeof(pixels));
      any[i] |= pixels;
    }
  }
  for (; x + 8 <= count; x += 8) {
    std::uint64_t pixels;
    std::memcpy(&pixels, row + x, sizeof(pixels));
    any[0] |= pixels;
  }
  for (; x < count; ++x) any[0] |= row[x];
  for (int i = 1; i < words; ++i) any[0] |= any[i];
  return any[0] != 0;
}

/// The last non-zero of `count` pixels; -1 if there is none.
inline int last_set(const std::uint8_t* row, int count) {
  constexpr int step = 32;
  int end = count;
  while (end >= step && !any_set(row + end - step, step)) end -= step;
  while (end > 0 && row[end - 1] == 0) --end;
  return end - 1;
}

/// The smallest rectangle that contains all non-zero pixels inside `part` of a mask whose rows are
/// `stride` bytes apart.
inline Rect bounding_box(const std::uint8_t* mask, std::ptrdiff_t stride, const Rect& part) {
  int left = part.width;
  int right = -1;
  const auto row = [&](int y) { return mask + y * stride + part.x; };
  const auto is_empty = [&](int y) { return !any_set(row(y), part.width); };
  int top = part.y;
  int bottom = part.bottom() - 1;
  while (top <= bottom && is_empty(top)) ++top;
  while (bottom > top && is_empty(bottom)) --bottom;
  for (int y = top; y <= bottom; ++y) {
    left = find_other(row(y), 0, left, 0);
    right += 1 + last_set(row(y) + right + 1, part.width - right - 1);
  }
  if (top > bottom) return {};
  return {part.x + left, top, right - left + 1, bottom - top + 1};
}

}  // namespace diminish
