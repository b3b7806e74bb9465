#include "detect/difference/object_regions.h"

#include <algorithm>
#include <cmath>

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
  std::transform(shown.begin(), shown.end(), regions.begin(),
                 [](Shown what) -> std::uint8_t { return is_object(what) ? 255 : 0; });
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
    const bool is_large =
        region.pixels >= smallest_share * pixels || seen >= smallest_seen * pixels;
    if (is_large && certain >= least_evidence * region.pixels) continue;
    fill(region, 0, regions);
  }
  // What is too small to be an object is no hole in one, either.
  connected_.find(regions, Pixels::clear, Connectivity::eight);
  for (const ConnectedRegions::Region& region : connected_.regions()) {
    if (region.pixels < smallest_seen * pixels) fill(region, 255, regions);
  }
}

void ObjectRegions::fill(const ConnectedRegions::Region& region, std::uint8_t value,
                         Mask& regions) const {
  connected_.for_each_run(region, [&](const ConnectedRegions::Run& run) {
    std::fill(regions.row(run.y) + run.first, regions.row(run.y) + run.last, value);
  });
}

bool add_enlarged(const Mask& small, int shrinkage, Mask& mask) {
  const Rect box = intersect(grow(bounding_box(small), 1), small.bounds());
  if (box.empty()) return false;
  const auto scale = static_cast<float>(shrinkage);
  const auto center = [scale](float at) { return (at + 0.5F) * scale - 0.5F; };
  const Rect part = intersect(
      {box.x * shrinkage, box.y * shrinkage, box.width * shrinkage, box.height * shrinkage},
      mask.bounds());
  // What the small mask leaves over at the picture's right and lower sides belongs to its last
  // column and row.
  const int right = box.right() == small.width() ? mask.width() : part.right();
  const int bottom = box.bottom() == small.height() ? mask.height() : part.bottom();
  for_rows(bottom - part.y, [&](Rows rows) {
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      const float at = std::max(0.F, (static_cast<float>(y) + 0.5F) / scale - 0.5F);
      const int above = std::min(static_cast<int>(at), small.height() - 1);
      const int below = std::min(above + 1, small.height() - 1);
      const float share = at - static_cast<float>(above);
      const auto value = [&](int x) {
        return (1 - share) * static_cast<float>(small(x, above)) +
               share * static_cast<float>(small(x, below));
      };
      // Runs between the places where the interpolated value becomes one half.
      constexpr float half = 127.5F;
      std::uint8_t* const row = mask.row(y);
      float left = value(box.x);
      int from = part.x;
      for (int x = box.x; x < box.right(); ++x) {
        const float next = value(std::min(x + 1, small.width() - 1));
        const bool is_last = x + 1 == box.right();
        if ((left >= half) != (next >= half)) {
          const float edge = center(static_cast<float>(x) + (half - left) / (next - left));
          const int to = static_cast<int>(std::ceil(edge));
          if (left >= half) std::fill(row + from, row + to, std::uint8_t{255});
          from = to;
        }
        if (is_last && next >= half) std::fill(row + from, row + right, std::uint8_t{255});
        left = next;
      }
    }
  });
  return true;
}

}  // namespace diminish
