#include "detect/disc_dilation.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace diminish {
namespace {

/// Calls visit(begin, end) for each run of pixels in [begin, end) of a row that `is_set`.
template <class IsSet, class Visit>
void for_each_run(const std::uint8_t* row, int begin, int end, const IsSet& is_set, Visit&& visit) {
  for (int x = begin; x < end;) {
    while (x < end && !is_set(row[x])) ++x;
    const int run = x;
    while (x < end && is_set(row[x])) ++x;
    if (x > run) visit(run, x);
  }
}

/// The part of `mask` as it is now.
void copy_part(const Mask& mask, const Rect& part, Mask& copy) {
  copy.resize(part.width, part.height);
  for (int y = 0; y < part.height; ++y) {
    std::copy_n(mask.row(part.y + y) + part.x, part.width, copy.row(y));
  }
}

/// Writes `value` to `target` within `radius` of every pixel of `source` that `is_set`: a row's
/// runs, widened as the disc is wide, are drawn into the rows above and below.
/// part: where `source` lies in `target`.
template <class IsSet>
void spread_runs(const Mask& source, const Rect& part, int radius, const IsSet& is_set,
                 std::uint8_t value, Mask& target) {
  std::vector<int> half_widths;
  for (int dy = 0; dy <= radius; ++dy) {
    int half_width = static_cast<int>(std::sqrt(static_cast<double>(radius * radius - dy * dy)));
    half_widths.push_back(half_width);
  }
  for (int y = part.y; y < part.bottom(); ++y) {
    for_each_run(source.row(y - part.y), 0, part.width, is_set, [&](int run, int run_end) {
      const int begin = part.x + run;
      const int end = part.x + run_end;
      const int first_row = std::max(0, y - radius);
      const int last_row = std::min(target.height() - 1, y + radius);
      for (int row = first_row; row <= last_row; ++row) {
        const int half_width = half_widths[std::abs(row - y)];
        const int first = std::max(0, begin - half_width);
        const int last = std::min(target.width(), end + half_width);
        std::fill(target.row(row) + first, target.row(row) + last, value);
      }
    });
  }
}

}  // namespace

void dilate_by_disc(Mask& mask, int radius, Mask& scratch) {
  const Rect box = bounding_box(mask);
  copy_part(mask, box, scratch);
  const auto is_set = [](std::uint8_t value) { return value != 0; };
  spread_runs(scratch, box, radius, is_set, 255, mask);
}

void close_by_disc(Mask& mask, int radius, Mask& scratch) {
  const Rect box = bounding_box(mask);
  dilate_by_disc(mask, radius, scratch);
  // What the dilation left empty eats back as far. Beyond the picture's border is nothing that
  // would.
  const Rect part = intersect(grow(box, 2 * radius + 1), mask.bounds());
  copy_part(mask, part, scratch);
  const auto is_empty = [](std::uint8_t value) { return value == 0; };
  spread_runs(scratch, part, radius, is_empty, 0, mask);
}

}  // namespace diminish
