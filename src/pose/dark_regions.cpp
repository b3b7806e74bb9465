#include "pose/dark_regions.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pose/dark_regions.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Included once for every instruction set.
#ifndef DIMINISH_POSE_DARK_REGIONS_RULE
#define DIMINISH_POSE_DARK_REGIONS_RULE
namespace diminish::dark_regions {

/// Half the side of the square around a pixel. Small, so that a marker does not grow together with
/// the shadow around its margin.
constexpr int radius = 2;
constexpr int side = 2 * radius + 1;
/// A dark pixel's brightness times this is less than the sum of the square: 7 % below its mean.
constexpr int scale = 27;
static_assert(side == 5 && scale * (255 + 2) < 65536, "the sums below are written out, in 16 bits");
/// In levels: what noise does not reach in a dark picture.
constexpr int min_contrast = 2;

}  // namespace diminish::dark_regions
#endif

HWY_BEFORE_NAMESPACE();
namespace diminish::dark_regions::HWY_NAMESPACE {
namespace {

/// Plain loops, which the compiler vectorises for each instruction set. rows: the pixel's, `radius`
/// above and below. Nothing is dark in the margins.
void FindDark(const std::uint8_t* const (&rows)[side], int width, std::uint16_t* sums,
              std::uint8_t* dark) {
  for (int x = 0; x < width; ++x) {
    sums[x] =
        static_cast<std::uint16_t>(rows[0][x] + rows[1][x] + rows[2][x] + rows[3][x] + rows[4][x]);
  }
  const std::uint8_t* const row = rows[radius];
  for (int x = radius; x < width - radius; ++x) {
    const auto around =
        static_cast<std::uint16_t>(sums[x - 2] + sums[x - 1] + sums[x] + sums[x + 1] + sums[x + 2]);
    const auto own = static_cast<std::uint16_t>(scale * row[x] + scale * min_contrast);
    dark[x] = own < around ? 255 : 0;
  }
}

}  // namespace
}  // namespace diminish::dark_regions::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace dark_regions {
namespace {

HWY_EXPORT(FindDark);

void find_dark(const std::uint8_t* const (&rows)[side], int width, std::uint16_t* sums,
               std::uint8_t* dark) {
  HWY_DYNAMIC_DISPATCH(FindDark)(rows, width, sums, dark);
}

}  // namespace
}  // namespace dark_regions

const ConnectedRegions& DarkRegions::find(const Image<std::uint8_t>& small) {
  using namespace dark_regions;
  const int width = small.width();
  const int height = small.height();
  for_rows(height, [&](Rows part) {
    Band& band = bands_[part.band];
    band.runs.clear();
    band.column_sums.resize(static_cast<std::size_t>(width));
    band.dark.assign(static_cast<std::size_t>(width), 0);
    if (width <= 2 * radius) return;
    for (int y = std::max(part.first, radius); y < std::min(part.last, height - radius); ++y) {
      const std::uint8_t* rows[side];
      for (int i = 0; i < side; ++i) rows[i] = small.row(y - radius + i);
      find_dark(rows, width, band.column_sums.data(), band.dark.data());
      for_each_run(band.dark.data(), 0, width, Pixels::set, [&](int first, int last) {
        band.runs.push_back({y, first, last});
      });
    }
  });
  regions_.begin();
  const int band_count = (height + band_height(height) - 1) / band_height(height);
  for (int i = 0; i < band_count; ++i) {
    for (const Run& run : bands_[i].runs) regions_.add(run.y, run.first, run.last);
  }
  regions_.connect(Connectivity::four);
  return regions_;
}

}  // namespace diminish
#endif
