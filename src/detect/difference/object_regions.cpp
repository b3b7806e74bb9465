#include "detect/difference/object_regions.h"

#include <algorithm>

#include "core/rows.h"

namespace diminish {
namespace {

/// Of the picture: fewer pixels are no region, unless RGB-D cameras see what stands there.
constexpr double smallest_share = 0.008;
constexpr double smallest_seen = 0.0015;
/// Of a region's pixels that are not guessed.
constexpr double least_evidence = 0.3;

}  // namespace

void ObjectRegions::find(const Image<Shown>& evidence, const Image<Shown>& shown, Mask& regions) {
  regions.resize(shown.width(), shown.height());
  std::transform(shown.begin(), shown.end(), regions.begin(), [](Shown what) -> std::uint8_t {
    return is_object(what) ? 255 : 0;
  });
  connected_.find(regions, Pixels::set, Connectivity::four);
  const auto pixels = static_cast<double>(regions.size());
  for (const ConnectedRegions::Region& region : connected_.regions()) {
    int certain = 0;
    int seen = 0;
    connected_.for_each_run(region, [&](const ConnectedRegions::Run& run) {
      const Shown* const row = evidence.row(run.y);
      certain += static_cast<int>(std::count_if(row + run.first, row + run.last, is_object));
      seen += static_cast<int>(std::count(row + run.first, row + run.last, Shown::object));
    });
    const bool is_large = region.pixels >= smallest_share * pixels ||
                          seen >= smallest_seen * pixels;
    if (is_large && certain >= least_evidence * region.pixels) continue;
    connected_.for_each_run(region, [&](const ConnectedRegions::Run& run) {
      std::fill(regions.row(run.y) + run.first, regions.row(run.y) + run.last, std::uint8_t{0});
    });
  }
}

bool add_enlarged(const Mask& small, int shrinkage, Mask& mask) {
  const Rect box = bounding_box(small);
  if (box.empty()) return false;
  const Rect around = grow(box, 1);
  const Rect part = intersect({around.x * shrinkage, around.y * shrinkage,
                               around.width * shrinkage, around.height * shrinkage},
                              mask.bounds());
  const float scale = 1.F / static_cast<float>(shrinkage);
  const auto at = [&](int x, int y) {
    return static_cast<float>(
        small(std::clamp(x, 0, small.width() - 1), std::clamp(y, 0, small.height() - 1)));
  };
  for_rows(part.height, [&](Rows rows) {
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      const float small_y = (static_cast<float>(y) + 0.5F) * scale - 0.5F + 1;
      const int row = static_cast<int>(small_y) - 1;
      const float below = small_y - static_cast<float>(row + 1);
      for (int x = part.x; x < part.right(); ++x) {
        const float small_x = (static_cast<float>(x) + 0.5F) * scale - 0.5F + 1;
        const int column = static_cast<int>(small_x) - 1;
        const float right = small_x - static_cast<float>(column + 1);
        const float above_value =
            (1 - right) * at(column, row) + right * at(column + 1, row);
        const float below_value =
            (1 - right) * at(column, row + 1) + right * at(column + 1, row + 1);
        if ((1 - below) * above_value + below * below_value >= 127.5F) mask(x, y) = 255;
      }
    }
  });
  return true;
}

}  // namespace diminish
