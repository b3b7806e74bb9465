#include "depth/depth_smoothing.h"

#include <algorithm>
#include <cstddef>

namespace diminish {
namespace {

constexpr int window_reach = plane_windows::reach;
using Columns = DepthPart::Columns;

/// A window that deviates by this much more than usual (a variance) has half of the weight.
constexpr float much = 2.5F;
/// The noise is measured in windows that are so far apart.
constexpr int sampled_rows = 16;
constexpr int sampled_columns = 4;

Columns clip(const Columns& columns, int first, int last) {
  return {std::max(columns.first, first), std::min(columns.last, last)};
}
/// Of the windows that reach these columns. middles: of all windows.
Columns windows_around(const Columns& columns, const Rect& middles) {
  return clip({columns.first - window_reach, columns.last + window_reach}, middles.x,
              middles.right());
}

/// Calls visit(y, band, columns around the row) for rows of a part and those around it.
template <class Visit>
void for_rows_around(const DepthPart& part, const Rect& middles, const Visit& visit) {
  const Rect bounds = intersect(grow(part.bounds(), window_reach), middles);
  for_rows(bounds.height, [&](Rows rows) {
    for (int y = bounds.y + rows.first; y < bounds.y + rows.last; ++y) {
      const Columns columns = part.columns_between(y - window_reach, y + window_reach + 1);
      if (columns.count() > 0) visit(y, rows.band, columns);
    }
  });
}

}  // namespace

plane_windows::Planes DepthSmoothing::planes(int y, int x) {
  return {depth_.row(y) + x, slope_x_.row(y) + x, slope_y_.row(y) + x, variance_.row(y) + x};
}
plane_windows::Sums DepthSmoothing::sums(int y, int x) {
  return {variance_.row(y) + x, depth_.row(y) + x, slope_y_.row(y) + x};
}

/// The median of the windows' variances; 0 if there is no window. Of all of the image, whatever
/// part of it is smoothed: another machine that smooths another part measures the same.
float DepthSmoothing::usual_variance(ImageView<std::uint16_t> measured) {
  const int windows = measured.width() - 2 * window_reach;
  const auto pitch = measured.stride() / std::ptrdiff_t{sizeof(std::uint16_t)};
  samples_.clear();
  for (int y = window_reach; y < measured.height() - window_reach; y += sampled_rows) {
    const std::uint16_t* const row = measured.row(y) + window_reach;
    const plane_windows::Planes row_planes = planes(y, window_reach);
    plane_windows::fit({row, pitch, windows, unit_m_, {}}, row_planes, scratch_[0].columns.data());
    for (int x = 0; x < windows; x += sampled_columns) {
      if (row[x] != 0) samples_.push_back(row_planes.variance[x]);
    }
  }
  if (samples_.empty()) return 0;
  const auto middle = samples_.begin() + static_cast<std::ptrdiff_t>(samples_.size() / 2);
  std::nth_element(samples_.begin(), middle, samples_.end());
  return *middle;
}

void DepthSmoothing::smooth(ImageView<std::uint16_t> measured, const DepthPart& part,
                            Image<std::uint16_t>& depth) {
  const int width = depth.width();
  for (Image<float>* image : {&depth_, &slope_x_, &slope_y_, &variance_}) {
    image->resize(width, depth.height());
  }
  // Of windows that do not reach beyond the image.
  const Rect middles{window_reach, window_reach, width - 2 * window_reach,
                     depth.height() - 2 * window_reach};
  if (middles.width <= 0 || middles.height <= 0) return;
  for (Scratch& scratch : scratch_) {
    scratch.columns.resize(3 * static_cast<std::size_t>(width));
    scratch.row.resize(4 * static_cast<std::size_t>(width + 2 * window_reach));
  }
  const float variance = usual_variance(measured);
  if (variance <= 0) return;
  for_rows_around(part, middles, [&](int y, int band, const Columns& around) {
    const Columns columns = windows_around(around, middles);
    if (columns.count() <= 0) return;
    plane_windows::fit({depth.row(y) + columns.first, width, columns.count(), unit_m_, {}},
                       planes(y, columns.first),
                       scratch_[static_cast<std::size_t>(band)].columns.data());
  });
  for_rows_around(part, middles, [&](int y, int band, const Columns& around) {
    const Columns columns = windows_around(around, middles);
    if (columns.count() <= 0) return;
    plane_windows::add_up({planes(y, columns.first), columns.first - around.first, columns.count()},
                          much * variance, around.count(), sums(y, around.first),
                          scratch_[static_cast<std::size_t>(band)].row.data());
  });
  for_each_row(part, depth.bounds(), [&](int y, const Columns& columns) {
    plane_windows::Around around{};
    const int first = std::max(y - window_reach, middles.y);
    around.first = first - y;
    for (int row = first; row <= std::min(y + window_reach, middles.bottom() - 1); ++row) {
      around.rows[static_cast<std::size_t>(around.count++)] = sums(row, columns.first);
    }
    plane_windows::mix(around, columns.count(), depth.row(y) + columns.first);
  });
}

}  // namespace diminish
