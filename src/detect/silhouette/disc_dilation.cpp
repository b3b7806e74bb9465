#include "detect/silhouette/disc_dilation.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace diminish {
namespace {

/// The first pixel of a row from x on that `is_set`, or is not, as `wanted`; `end` if there is
/// none.
template <class IsSet>
int find(const std::uint8_t* row, int x, int end, const IsSet& is_set, bool wanted) {
  constexpr int step = sizeof(std::uint64_t);
  // Most pixels have neighbours that are the same.
  for (; x + step <= end && is_set(row[x]) != wanted; x += step) {
    std::uint64_t pixels = 0;
    std::memcpy(&pixels, row + x, sizeof(pixels));
    if (pixels != row[x] * 0x0101010101010101U) break;
  }
  while (x < end && is_set(row[x]) != wanted) ++x;
  return x;
}

/// Calls visit(begin, end) for each run of pixels in [begin, end) of a row that `is_set`.
template <class IsSet, class Visit>
void for_each_run(const std::uint8_t* row, int begin, int end, const IsSet& is_set, Visit&& visit) {
  for (int x = begin; x < end;) {
    const int run = find(row, x, end, is_set, true);
    x = find(row, run, end, is_set, false);
    if (x > run) visit(run, x);
  }
}

}  // namespace

void DiscDilation::dilate(Mask& mask, const Rect& part, int radius) {
  copy_part(mask, part);
  const auto is_set = [](std::uint8_t value) { return value != 0; };
  spread_runs(part, radius, is_set, 255, mask);
}

void DiscDilation::close(Mask& mask, int radius) {
  const Rect box = bounding_box(mask);
  dilate(mask, box, radius);
  // What the dilation left empty eats back as far. Beyond the picture's border is nothing that
  // would.
  const Rect part = intersect(grow(box, 2 * radius + 1), mask.bounds());
  copy_part(mask, part);
  const auto is_empty = [](std::uint8_t value) { return value == 0; };
  spread_runs(part, radius, is_empty, 0, mask);
}

/// The part of `mask` as it is now.
void DiscDilation::copy_part(const Mask& mask, const Rect& part) {
  before_.resize(part.width, part.height);
  for (int y = 0; y < part.height; ++y) {
    std::copy_n(mask.row(part.y + y) + part.x, part.width, before_.row(y));
  }
}

/// Writes `value` to `target` within `radius` of every pixel that `is_set` was true of: a row's
/// runs, widened as the disc is wide, are drawn into the rows above and below.
/// part: where what was before lies in `target`.
template <class IsSet>
void DiscDilation::spread_runs(const Rect& part, int radius, const IsSet& is_set,
                               std::uint8_t value, Mask& target) {
  half_widths_.clear();
  for (int dy = 0; dy <= radius; ++dy) {
    half_widths_.push_back(
        static_cast<int>(std::sqrt(static_cast<double>(radius * radius - dy * dy))));
  }
  for (int y = part.y; y < part.bottom(); ++y) {
    for_each_run(before_.row(y - part.y), 0, part.width, is_set, [&](int run, int run_end) {
      const int begin = part.x + run;
      const int end = part.x + run_end;
      const int first_row = std::max(0, y - radius);
      const int last_row = std::min(target.height() - 1, y + radius);
      for (int row = first_row; row <= last_row; ++row) {
        const int half_width = half_widths_[static_cast<std::size_t>(std::abs(row - y))];
        const int first = std::max(0, begin - half_width);
        const int last = std::min(target.width(), end + half_width);
        std::fill(target.row(row) + first, target.row(row) + last, value);
      }
    });
  }
}

}  // namespace diminish
