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

/// The middles of windows that do not reach beyond the image.
template <class Image>
Rect middles_of(const Image& depth) {
  return grow(depth.bounds(), -window_reach);
}

}  // namespace

plane_windows::Planes DepthSmoothing::Scratch::planes_at(int y, int x) {
  const int kept = y % plane_windows::side;
  return {planes[0].row(kept) + x, planes[1].row(kept) + x, planes[2].row(kept) + x,
          planes[3].row(kept) + x};
}
plane_windows::Sums DepthSmoothing::Scratch::sums_at(int y, int x) {
  const plane_windows::Planes there = planes_at(y, x);
  return {there.variance, there.depth, there.slope_y};
}

/// The median of the windows' variances; 0 if there is no window. Of all of the image, whatever
/// part of it is smoothed: another machine that smooths another part measures the same.
float DepthSmoothing::usual_variance(ImageView<std::uint16_t> measured) {
  const std::ptrdiff_t windows = measured.width() - 2 * window_reach;
  const auto pitch = measured.stride() / std::ptrdiff_t{sizeof(std::uint16_t)};
  samples_.clear();
  float* const scratch = scratch_[0].row.data();
  const plane_windows::Planes row_planes{scratch, scratch + windows, scratch + 2 * windows,
                                         scratch + 3 * windows};
  for (int y = window_reach; y < measured.height() - window_reach; y += sampled_rows) {
    const std::uint16_t* const row = measured.row(y) + window_reach;
    plane_windows::fit({row, pitch, static_cast<int>(windows), unit_m_, {}}, row_planes,
                       scratch_[0].columns.data());
    for (int x = 0; x < windows; x += sampled_columns) {
      if (row[x] != 0) samples_.push_back(row_planes.variance[x]);
    }
  }
  if (samples_.empty()) return 0;
  const auto middle = samples_.begin() + static_cast<std::ptrdiff_t>(samples_.size() / 2);
  std::nth_element(samples_.begin(), middle, samples_.end());
  return *middle;
}

/// Rows of the part's bounds. A row's planes are kept until all rows that they reach are done.
void DepthSmoothing::smooth_band(const Image<std::uint16_t>& given, const DepthPart& part,
                                 Rows rows, float half_variance, Image<std::uint16_t>& smoothed) {
  Scratch& scratch = scratch_[static_cast<std::size_t>(rows.band)];
  const Rect middles = middles_of(given);
  const auto add_windows = [&](int y) {
    const Columns around = part.columns_between(y - window_reach, y + window_reach + 1);
    const Columns columns = windows_around(around, middles);
    if (around.count() <= 0 || columns.count() <= 0) return;
    plane_windows::fit({given.row(y) + columns.first, given.width(), columns.count(), unit_m_, {}},
                       scratch.planes_at(y, columns.first), scratch.columns.data());
    plane_windows::add_up(
        {scratch.planes_at(y, columns.first), columns.first - around.first, columns.count()},
        half_variance, around.count(), scratch.sums_at(y, around.first), scratch.row.data());
  };
  const auto mix = [&](int y) {
    const Columns& columns = part.columns(y);
    if (columns.count() <= 0) return;
    plane_windows::Around around{};
    const int first = std::max(y - window_reach, middles.y);
    around.first = first - y;
    for (int row = first; row <= std::min(y + window_reach, middles.bottom() - 1); ++row) {
      around.rows[static_cast<std::size_t>(around.count++)] = scratch.sums_at(row, columns.first);
    }
    plane_windows::mix(around, columns.count(), smoothed.row(y) + columns.first);
  };
  const int begin = part.bounds().y + rows.first;
  const int end = part.bounds().y + rows.last;
  for (int y = begin - window_reach; y < end + window_reach; ++y) {
    if (y >= middles.y && y < middles.bottom()) add_windows(y);
    if (y - window_reach >= begin) mix(y - window_reach);
  }
}

void DepthSmoothing::smooth(ImageView<std::uint16_t> measured, const Image<std::uint16_t>& given,
                            const DepthPart& part, Image<std::uint16_t>& smoothed) {
  for_each_row(part, given.bounds(), [&](int y, const Columns& columns) {
    std::copy_n(given.row(y) + columns.first, columns.count(), smoothed.row(y) + columns.first);
  });
  if (middles_of(given).empty()) return;
  const int width = given.width();
  for (Scratch& scratch : scratch_) {
    scratch.columns.resize(3 * static_cast<std::size_t>(width));
    scratch.row.resize(4 * static_cast<std::size_t>(width + 2 * window_reach));
    for (Image<float>& plane : scratch.planes) plane.resize(width, plane_windows::side);
  }
  const float variance = usual_variance(measured);
  if (variance <= 0) return;
  for_rows(part.bounds().height,
           [&](Rows rows) { smooth_band(given, part, rows, much * variance, smoothed); });
}

}  // namespace diminish
