#include "composite/scale_light.h"

#include <algorithm>

#include "core/runs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "composite/scale_light.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Included once for every instruction set.
#ifndef DIMINISH_COMPOSITE_SCALE_LIGHT_PART
#define DIMINISH_COMPOSITE_SCALE_LIGHT_PART
namespace diminish {

/// The pixels from one cell's middle to the next one's.
struct LightPart {
  static constexpr int size = LightGains::cell_px;
  int left[3], right[3];  ///< the gains in the cells' middles
  const std::uint8_t* labels;
  Bgr* light;
};

}  // namespace diminish
#endif

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

void ScaleLight(const LightGains& gains, const LightPart& part) {
  const hn::CappedTag<std::uint8_t, LightPart::size> bytes;
  const hn::Rebind<std::uint16_t, decltype(bytes)> d;
  const auto half = hn::Set(d, LightGains::one / 2);
  const auto most_dark = hn::Set(d, gains.most_dark);
  const auto lanes = static_cast<int>(hn::Lanes(bytes));
  for (int i = 0; i < LightPart::size; i += lanes) {
    const auto labels = hn::PromoteTo(d, hn::LoadU(bytes, part.labels + i));
    const auto is_own = hn::Eq(labels, hn::Set(d, gains.label));
    // Sixteenths of the way to the right.
    const auto way = hn::Iota(d, static_cast<std::uint16_t>(i));
    const auto share = hn::Add(hn::Add(way, way), hn::Set(d, 1));
    const auto scale = [&](int c, auto& levels) HWY_ATTR {
      // Unsigned: what wraps around on the way comes back.
      const auto step = hn::Set(d, static_cast<std::uint16_t>(part.right[c] - part.left[c]));
      const auto left = hn::Set(d, static_cast<std::uint16_t>(16 * part.left[c]));
      const auto between = hn::ShiftRight<4>(hn::Add(left, hn::Mul(share, step)));
      const auto gain = hn::IfThenElse(is_own, between, hn::Set(d, LightGains::one));
      const auto lost = hn::Sub(hn::Set(d, 255), hn::PromoteTo(d, levels));
      const auto scaled = hn::ShiftRight<6>(hn::Add(hn::Mul(gain, lost), half));
      static_assert(LightGains::one == 1 << 6);
      const auto left_over = hn::Sub(hn::Set(d, 255), hn::Min(scaled, most_dark));
      levels = hn::DemoteTo(bytes, hn::BitCast(hn::RebindToSigned<decltype(d)>(), left_over));
    };
    auto* const light = reinterpret_cast<std::uint8_t*>(part.light + i);
    hn::Vec<decltype(bytes)> blue, green, red;
    hn::LoadInterleaved3(bytes, light, blue, green, red);
    scale(0, blue);
    scale(1, green);
    scale(2, red);
    hn::StoreInterleaved3(blue, green, red, bytes, light);
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(ScaleLight);

}  // namespace

void scale_light(const LightGains& gains, const std::uint8_t* labels, int count, Bgr* light) {
  constexpr int size = LightPart::size;
  const auto last = static_cast<int>(gains.by_cell.size()) - 1;
  const auto cell = [&](int i) -> const Eigen::Array4i& {
    return gains.by_cell[static_cast<std::size_t>(std::clamp(i, 0, last))];
  };
  const int least_level = 255 - gains.most_dark;
  const bool may_leave_out = least_level <= 128;
  const auto do_part = HWY_DYNAMIC_DISPATCH(ScaleLight);
  // The first part begins half a cell before the row.
  for (int x = -size / 2, i = -1; x < count; x += size, ++i) {
    const int begin = std::max(x, 0);
    const int end = std::min(x + size, count);
    const bool is_whole = end - begin == size;
    const auto* const levels = reinterpret_cast<const std::uint8_t*>(light + begin);
    if (is_whole && all_equal<3 * size>(levels, 255)) continue;
    // What has another label keeps its light.
    if (is_whole && may_leave_out && find_equal(labels, x, x + size, gains.label) == x + size &&
        !is_any_below<3 * size>(levels, least_level)) {
      continue;
    }
    const Eigen::Array4i& left = cell(i);
    const Eigen::Array4i& right = cell(i + 1);
    LightPart part{
        {left[0], left[1], left[2]}, {right[0], right[1], right[2]}, labels + x, light + x};
    if (is_whole) {
      do_part(gains, part);
      continue;
    }
    // At an end of the row, beyond which nothing may be read.
    std::uint8_t own_labels[size] = {};
    Bgr own_light[size] = {};
    std::copy(labels + begin, labels + end, own_labels + (begin - x));
    std::copy(light + begin, light + end, own_light + (begin - x));
    part.labels = own_labels;
    part.light = own_light;
    do_part(gains, part);
    std::copy_n(own_light + (begin - x), end - begin, light + begin);
  }
}

}  // namespace diminish
#endif
