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

/// Writes `value` to `target` within `radius` of every pixel that was set, or clear: into each row
/// go the runs of the rows above and below, widened as the disc is wide, together.
/// part: where what was before lies in `target`.
void DiscDilation::spread_runs(const Rect& part, int radius, Pixels pixels, std::uint8_t value,
                               Mask& target) {
  half_widths_.clear();
  for (int dy = 0; dy <= radius; ++dy) {
    half_widths_.push_back(
        static_cast<int>(std::sqrt(static_cast<double>(radius * radius - dy * dy))));
  }
  runs_.find(before_, before_.bounds(), pixels);
  const int first_row = std::max(0, part.y - radius);
  const int last_row = std::min(target.height(), part.bottom() + radius);
  for (int y = first_row; y < last_row; ++y) {
    joined_.clear();
    runs_.for_each_near(y - part.y, radius, [&](const ColumnRun& run, int rows) {
      const int half_width = half_widths_[static_cast<std::size_t>(rows)];
      joined_.add({std::max(0, part.x + run.first - half_width),
                   std::min(target.width(), part.x + run.last + half_width)});
    });
    for (const ColumnRun& run : joined_.runs()) {
      std::fill(target.row(y) + run.first, target.row(y) + run.last, value);
    }
  }
}

}  // namespace diminish
