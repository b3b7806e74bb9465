#include "detect/silhouette/disc_dilation.h"

#include <algorithm>
#include <cmath>

namespace diminish {

void DiscDilation::dilate(Mask& mask, const Rect& part, int radius) {
  copy_part(mask, part);
  spread_runs(part, radius, Pixels::set, 255, mask);
}

void DiscDilation::close(Mask& mask, int radius) {
  const Rect box = bounding_box(mask);
  dilate(mask, box, radius);
  // What the dilation left empty eats back as far. Beyond the picture's border is nothing that
  // would.
  const Rect part = intersect(grow(box, 2 * radius + 1), mask.bounds());
  copy_part(mask, part);
  spread_runs(part, radius, Pixels::clear, 0, mask);
}

/// The part of `mask` as it is now.
void DiscDilation::copy_part(const Mask& mask, const Rect& part) {
  before_.resize(part.width, part.height);
  for (int y = 0; y < part.height; ++y) {
    std::copy_n(mask.row(part.y + y) + part.x, part.width, before_.row(y));
  }
}

/// Writes `value` to `target` within `radius` of every pixel that was set, or clear: a row's runs,
/// widened as the disc is wide, are drawn into the rows above and below.
/// part: where what was before lies in `target`.
void DiscDilation::spread_runs(const Rect& part, int radius, Pixels pixels, std::uint8_t value,
                               Mask& target) {
  half_widths_.clear();
  for (int dy = 0; dy <= radius; ++dy) {
    half_widths_.push_back(
        static_cast<int>(std::sqrt(static_cast<double>(radius * radius - dy * dy))));
  }
  for (int y = part.y; y < part.bottom(); ++y) {
    for_each_run(before_.row(y - part.y), 0, part.width, pixels, [&](int run, int run_end) {
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
