#include "composite/shadow_lifting.h"

#include <algorithm>

#include "core/rows.h"

namespace diminish {
namespace {

constexpr int fading_px = 12;
constexpr Bgr all_light{255, 255, 255};
constexpr std::uint8_t one = 1;

/// level * 255 / light, rounded. The quotient of two whole numbers of such a size is never so close
/// below a whole number that a float would reach it.
std::uint8_t lit(std::uint8_t level, std::uint8_t light) {
  const auto sum = static_cast<float>(level * 255 + light / 2);
  return static_cast<std::uint8_t>(std::min(255.F, sum / static_cast<float>(std::max(light, one))));
}

/// The rows of the region with less than all light.
Rect shaded_part(const Reconstruction& reconstruction) {
  const Rect& region = reconstruction.region;
  const auto is_shaded = [&](int y) {
    const Bgr* row = reconstruction.light.row(y) + region.x;
    return std::any_of(row, row + region.width,
                       [](const Bgr& light) { return light != all_light; });
  };
  int top = region.y;
  int bottom = region.bottom();
  while (top < bottom && !is_shaded(top)) ++top;
  while (bottom > top && !is_shaded(bottom - 1)) --bottom;
  // The mask's rim beside them counts, too.
  return intersect(grow({region.x, top, region.width, bottom - top}, fading_px), region);
}

}  // namespace

void ShadowLifting::lift(const Reconstruction& reconstruction, Image<Bgr>& picture) const {
  const Rect& region = reconstruction.region;
  for_rows(region.height, [&](Rows rows) {
    for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
      // Channel by channel, some at a time: nearly all or none of them have all light.
      constexpr int step = 48;
      const auto* light =
          reinterpret_cast<const std::uint8_t*>(reconstruction.light.row(y) + region.x);
      auto* levels = reinterpret_cast<std::uint8_t*>(picture.row(y) + region.x);
      const int count = 3 * region.width;
      for (int first = 0; first < count; first += step) {
        const int end = std::min(first + step, count);
        std::uint8_t least = 255;
        for (int i = first; i < end; ++i) least = std::min(least, light[i]);
        if (least == 255) continue;
        for (int i = first; i < end; ++i) levels[i] = lit(levels[i], light[i]);
      }
    }
  });
}

void ShadowLifting::restore_outside(const Image<Bgr>& camera, const Mask& occlusion,
                                    const Reconstruction& reconstruction, Image<Bgr>& picture) {
  const Rect part = shaded_part(reconstruction);
  measure_distances(occlusion, part);
  for_rows(part.height, [&](Rows rows) {
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      const Bgr* light = reconstruction.light.row(y);
      const std::uint8_t* distances = distances_.row(y - part.y) - part.x;
      Bgr* colors = picture.row(y);
      for (int x = part.x; x < part.right(); ++x) {
        if (distances[x] >= fading_px || light[x] == all_light) continue;
        if (distances[x] == 0) {
          colors[x] = camera(x, y);
          continue;
        }
        const auto shaded = [&](int level, int light_level) {
          const int dark = (255 - light_level) * (fading_px - distances[x]);
          constexpr int full = 255 * fading_px;
          return static_cast<std::uint8_t>((level * (full - dark) + full / 2) / full);
        };
        colors[x] = {shaded(colors[x].b, light[x].b), shaded(colors[x].g, light[x].g),
                     shaded(colors[x].r, light[x].r)};
      }
    }
  });
}

/// In steps along rows and columns, first those along rows. Beyond `part` there is no rim.
void ShadowLifting::measure_distances(const Mask& occlusion, const Rect& part) {
  distances_.resize(part.width, part.height);
  for_rows(part.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint8_t* mask = occlusion.row(part.y + y) + part.x;
      std::uint8_t* own = distances_.row(y);
      int distance = fading_px;
      for (int x = 0; x < part.width; ++x) {
        distance = mask[x] != 0 ? std::min(distance + 1, fading_px) : 0;
        own[x] = static_cast<std::uint8_t>(distance);
      }
      distance = fading_px;
      for (int x = part.width - 1; x >= 0; --x) {
        distance = std::min(distance + 1, int{own[x]});
        own[x] = static_cast<std::uint8_t>(distance);
      }
    }
  });
  const auto pass_on = [&](const std::uint8_t* from, std::uint8_t* to) {
    for (int x = 0; x < part.width; ++x) {
      to[x] = std::min(to[x], static_cast<std::uint8_t>(from[x] + 1));
    }
  };
  for (int y = 1; y < part.height; ++y) pass_on(distances_.row(y - 1), distances_.row(y));
  for (int y = part.height - 1; y > 0; --y) pass_on(distances_.row(y), distances_.row(y - 1));
}

}  // namespace diminish
