#include "estimate/plane_sweep/census.h"

#include <algorithm>

#include "core/rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimate/plane_sweep/census.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// center: a pixel; two rows above and below, and two columns beside all pixels, can be read.
void CensusRow(const std::uint8_t* center, std::ptrdiff_t pitch, int count, std::uint32_t* codes) {
  const auto code = [&](auto d, int x) HWY_ATTR {
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const auto brightness = [&](std::ptrdiff_t at) HWY_ATTR {
      return hn::PromoteTo(d, hn::LoadU(bytes, center + x + at));
    };
    const auto own = brightness(0);
    const auto one = hn::Set(d, 1);
    auto bits = hn::Zero(d);
    for (int y = -2; y <= 2; ++y) {
      for (int dx = -2; dx <= 2; ++dx) {
        if (y == 0 && dx == 0) continue;
        const auto darker = hn::IfThenElseZero(hn::Lt(brightness(y * pitch + dx), own), one);
        bits = hn::Or(hn::ShiftLeft<1>(bits), darker);
      }
    }
    const auto is_unknown = hn::Eq(own, hn::Zero(d));
    hn::StoreU(
        hn::IfThenElse(is_unknown, hn::Set(d, static_cast<std::int32_t>(unknown_census)), bits), d,
        reinterpret_cast<std::int32_t*>(codes) + x);
  };
  const hn::CappedTag<std::int32_t, 16> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) code(d, x);
  for (; x < count; ++x) code(hn::CappedTag<std::int32_t, 1>(), x);
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(CensusRow);

constexpr int census_reach = 2;

}  // namespace

void census(const Image<std::uint8_t>& grey, const Rect& part, Image<std::uint32_t>& codes) {
  const Rect all = grey.bounds();
  const Rect inner = {census_reach, census_reach, all.width - 2 * census_reach,
                      all.height - 2 * census_reach};
  const Rect coded = inner.empty() ? Rect{} : intersect(part, inner);
  for_rows(part.height, [&](Rows rows) {
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      std::uint32_t* const row = codes.row(y);
      std::fill_n(row + part.x, part.width, unknown_census);
      if (coded.empty() || y < coded.y || y >= coded.bottom()) continue;
      HWY_DYNAMIC_DISPATCH(CensusRow)
      (grey.row(y) + coded.x, grey.width(), coded.width, row + coded.x);
    }
  });
}

}  // namespace diminish
#endif
