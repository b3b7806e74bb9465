#include "composite/shadow_lifting.h"

#include <algorithm>

#include "core/rows.h"
#include "core/runs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "composite/shadow_lifting.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/small_numbers-inl.h"

// Included once for every instruction set.
HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using Bytes = hn::Rebind<std::uint8_t, Floats>;

/// level * 255 / light, rounded. The quotient of two whole numbers of this size is never so close
/// below a whole number that a float would round up to it.
HWY_INLINE hn::Vec<Bytes> Lit(hn::Vec<Bytes> level, hn::Vec<Bytes> light) {
  const auto divisor = hn::PromoteTo(Ints(), light);
  const auto level_in_full = hn::Mul(hn::PromoteTo(Ints(), level), hn::Set(Ints(), 255));
  const auto sum = hn::ConvertTo(Floats(), hn::Add(level_in_full, hn::ShiftRight<1>(divisor)));
  const auto quotient =
      hn::Div(sum, hn::Max(hn::ConvertTo(Floats(), divisor), hn::Set(Floats(), 1.F)));
  const auto clamped = hn::Min(quotient, hn::Set(Floats(), 255.F));
  return hn::DemoteTo(Bytes(), TruncateSmall(clamped));
}

void Lift(const std::uint8_t* light, int count, std::uint8_t* levels) {
  const Bytes d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    hn::StoreU(Lit(hn::LoadU(d, levels + i), hn::LoadU(d, light + i)), d, levels + i);
  }
  if (i == count) return;
  // The last vector reaches past the row's end.
  std::uint8_t last_light[16] = {};
  std::uint8_t last_levels[16] = {};
  for (int k = 0; k < lanes && i + k < count; ++k) {
    last_light[k] = light[i + k];
    last_levels[k] = levels[i + k];
  }
  hn::StoreU(Lit(hn::LoadU(d, last_levels), hn::LoadU(d, last_light)), d, last_levels);
  for (int k = 0; k < lanes && i + k < count; ++k) levels[i + k] = last_levels[k];
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(Lift);

namespace {

constexpr int fading_px = ShadowLifting::fading_px;
constexpr Bgr all_light{255, 255, 255};
/// Calls visit(first, last) for ranges of a row's channels, skipping most of what has full light:
/// nearly all or none have it.
template <class Visit>
void for_each_shaded(const Bgr* row, int width, const Visit& visit) {
  constexpr int step = 48;
  const auto* const light = reinterpret_cast<const std::uint8_t*>(row);
  const int count = 3 * width;
  int begin = -1;
  for (int first = 0; first < count; first += step) {
    const int last = std::min(first + step, count);
    const bool is_lit = first + step <= count ? all_equal<step>(light + first, 255)
                                              : find_other(light, first, last, 255) == last;
    if (is_lit) {
      if (begin >= 0) visit(begin, first);
      begin = -1;
    } else if (begin < 0) {
      begin = first;
    }
  }
  if (begin >= 0) visit(begin, count);
}

/// Calls visit(x) for each of the columns [begin, end) that is nearer to the rim than `fading_px`,
/// but visit_outside(first, last) for most of those that are outside.
template <class VisitOutside, class Visit>
void for_each_within(const std::uint8_t* distances, int begin, int end,
                     const VisitOutside& visit_outside, const Visit& visit) {
  constexpr int step = 16;
  for (int first = begin; first < end; first += step) {
    const int last = std::min(first + step, end);
    if (first + step <= end) {
      if (all_equal<step>(distances + first, fading_px)) continue;
      if (all_equal<step>(distances + first, 0)) {
        visit_outside(first, last);
        continue;
      }
    }
    for (int x = first; x < last; ++x) {
      if (distances[x] < fading_px) visit(x);
    }
  }
}

/// The rows of the region that have shadows.
Rect shaded_part(const Surfaces& surfaces) {
  const Rect& region = surfaces.region;
  const auto is_shaded = [&](int y) {
    bool is_any = false;
    for_each_shaded(surfaces.light.row(y) + region.x, region.width,
                    [&](int, int) { is_any = true; });
    return is_any;
  };
  int top = region.y;
  int bottom = region.bottom();
  while (top < bottom && !is_shaded(top)) ++top;
  while (bottom > top && !is_shaded(bottom - 1)) --bottom;
  // The mask's rim beside them counts too.
  return intersect(grow({region.x, top, region.width, bottom - top}, fading_px), region);
}

/// The distance from each pixel of a row to the next pixel outside the mask, up to `fading_px`. Has
/// no dependences between pixels, so that the compiler vectorises it.
void measure_in_row(const std::uint8_t* mask, int width, std::uint8_t* distances,
                    std::vector<std::uint8_t>& padded) {
  // Nothing beyond the row is outside.
  constexpr int longest_step = 5;
  padded.assign(static_cast<std::size_t>(width) + std::size_t{2} * longest_step, fading_px);
  std::uint8_t* last = padded.data() + longest_step;
  for (int x = 0; x < width; ++x) distances[x] = mask[x] != 0 ? fading_px : 0;
  // Every distance is a sum of some of these steps.
  for (const int step : {1, 2, 4, longest_step}) {
    std::copy_n(distances, width, last);
    for (int x = 0; x < width; ++x) {
      const int beside = std::min(last[x - step], last[x + step]) + step;
      distances[x] = std::min(last[x], static_cast<std::uint8_t>(beside));
    }
  }
}

}  // namespace

void ShadowLifting::lift(const Surfaces& surfaces, Image<Bgr>& picture) const {
  const Rect& region = surfaces.region;
  for_rows(region.height, [&](Rows rows) {
    for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
      const Bgr* const light = surfaces.light.row(y) + region.x;
      const auto* const lights = reinterpret_cast<const std::uint8_t*>(light);
      auto* const levels = reinterpret_cast<std::uint8_t*>(picture.row(y) + region.x);
      for_each_shaded(light, region.width, [&](int first, int last) {
        HWY_DYNAMIC_DISPATCH(Lift)(lights + first, last - first, levels + first);
      });
    }
  });
}

void ShadowLifting::restore_outside(ImageView<Bgr> camera, const Mask& occlusion,
                                    const Surfaces& surfaces, Image<Bgr>& picture) {
  const Rect part = shaded_part(surfaces);
  measure_distances(occlusion, part);
  for_rows(part.height, [&](Rows rows) {
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      const Bgr* light = surfaces.light.row(y);
      const std::uint8_t* distances = distances_.row(y - part.y) - part.x;
      Bgr* colors = picture.row(y);
      // Nothing but lifting has changed what is outside.
      const auto restore = [&](int first, int last) {
        std::copy(camera.row(y) + first, camera.row(y) + last, colors + first);
      };
      for_each_within(distances, part.x, part.right(), restore, [&](int x) {
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

/// Counts steps along rows and columns, first along rows. There is no rim beyond `part`.
void ShadowLifting::measure_distances(const Mask& occlusion, const Rect& part) {
  distances_.resize(part.width, part.height);
  for_rows(part.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      measure_in_row(occlusion.row(part.y + y) + part.x, part.width, distances_.row(y),
                     padded_[rows.band]);
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
#endif
