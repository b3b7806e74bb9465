#include "composite/shadow_lifting.h"

#include <algorithm>

#include "core/rows.h"

namespace diminish {
namespace {

constexpr int fading_px = ShadowLifting::fading_px;
constexpr Bgr all_light{255, 255, 255};
constexpr std::uint8_t one = 1;

/// level * 255 / light, rounded. The quotient of two whole numbers of such a size is never so close
/// below a whole number that a float would reach it.
std::uint8_t lit(std::uint8_t level, std::uint8_t light) {
  const auto sum = static_cast<float>(level * 255 + light / 2);
  return static_cast<std::uint8_t>(std::min(255.F, sum / static_cast<float>(std::max(light, one))));
}

/// Channel by channel, some at a time: nearly all or none of them have all light.
void lift_row(const std::uint8_t* light, int count, std::uint8_t* levels) {
  constexpr int step = 48;
  for (int first = 0; first < count; first += step) {
    const int end = std::min(first + step, count);
    std::uint8_t least = 255;
    for (int i = first; i < end; ++i) least = std::min(least, light[i]);
    if (least == 255) continue;
    for (int i = first; i < end; ++i) levels[i] = lit(levels[i], light[i]);
  }
}

/// Calls visit(x) for each of the columns [begin, end) that is nearer than `fading_px`.
template <class Visit>
void for_each_within(const std::uint8_t* distances, int begin, int end, const Visit& visit) {
  constexpr int step = 16;
  for (int first = begin; first < end; first += step) {
    const int last = std::min(first + step, end);
    std::uint8_t least = fading_px;
    for (int x = first; x < last; ++x) least = std::min(least, distances[x]);
    if (least == fading_px) continue;
    for (int x = first; x < last; ++x) {
      if (distances[x] < fading_px) visit(x);
    }
  }
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

/// How far each pixel of a row is from the next outside the mask, up to `fading_px`. Without
/// dependences from pixel to pixel, so that the compiler takes many at a time.
void measure_in_row(const std::uint8_t* mask, int width, std::uint8_t* distances,
                    std::vector<std::uint8_t>& padded) {
  // Beyond the row there is no outside.
  constexpr int longest_step = 5;
  padded.assign(static_cast<std::size_t>(width) + 2 * longest_step, fading_px);
  std::uint8_t* last = padded.data() + longest_step;
  for (int x = 0; x < width; ++x) distances[x] = mask[x] != 0 ? fading_px : 0;
  // Every distance is a sum of some of these.
  for (const int step : {1, 2, 4, longest_step}) {
    std::copy_n(distances, width, last);
    for (int x = 0; x < width; ++x) {
      const int beside = std::min(last[x - step], last[x + step]) + step;
      distances[x] = std::min(last[x], static_cast<std::uint8_t>(beside));
    }
  }
}

}  // namespace

void ShadowLifting::lift(const Reconstruction& reconstruction, Image<Bgr>& picture) const {
  const Rect& region = reconstruction.region;
  for_rows(region.height, [&](Rows rows) {
    for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
      lift_row(reinterpret_cast<const std::uint8_t*>(reconstruction.light.row(y) + region.x),
               3 * region.width, reinterpret_cast<std::uint8_t*>(picture.row(y) + region.x));
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
      for_each_within(distances, part.x, part.right(), [&](int x) {
        if (light[x] == all_light) return;
        if (distances[x] == 0) {
          colors[x] = camera(x, y);
          return;
        }
        const auto shaded = [&](int level, int light_level) {
          const int dark = (255 - light_level) * (fading_px - distances[x]);
          constexpr int full = 255 * fading_px;
          return static_cast<std::uint8_t>((level * (full - dark) + full / 2) / full);
        };
        colors[x] = {shaded(colors[x].b, light[x].b), shaded(colors[x].g, light[x].g),
                     shaded(colors[x].r, light[x].r)};
      });
    }
  });
}

/// In steps along rows and columns, first those along rows. Beyond `part` there is no rim.
void ShadowLifting::measure_distances(const Mask& occlusion, const Rect& part) {
  distances_.resize(part.width, part.height);
  for_rows(part.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      measure_in_row(occlusion.row(part.y + y) + part.x, part.width, distances_.row(y),
                     padded_[rows.first == 0 ? 0 : 1]);
    }
  });
  const auto pass_on = [width = part.width](const std::uint8_t* from, std::uint8_t* to) {
    for (int x = 0; x < width; ++x) {
      to[x] = std::min(to[x], static_cast<std::uint8_t>(from[x] + 1));
    }
  };
  for (int y = 1; y < part.height; ++y) pass_on(distances_.row(y - 1), distances_.row(y));
  for (int y = part.height - 1; y > 0; --y) pass_on(distances_.row(y), distances_.row(y - 1));
}

}  // namespace diminish
