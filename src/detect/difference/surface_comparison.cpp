#include "detect/difference/surface_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "detect/difference/surface_comparison.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// A surface is read as two words.
static_assert(sizeof(SeenSurface) == 8 && offsetof(SeenSurface, color) == 4 &&
              offsetof(SeenSurface, source) == 7);
static_assert(sizeof(SurfaceDifference) == 12 && sizeof(Bgr) == 3);

template <class D>
HWY_INLINE void Compare(D d, const SeenSurface* nearest, const SeenSurface* farthest,
                        const Bgr* least, const Bgr* greatest, SurfaceDifference* differences) {
  const hn::RebindToSigned<D> di;
  const hn::RebindToUnsigned<D> du;
  const hn::Rebind<std::uint8_t, D> d8;
  using Bytes = hn::Vec<decltype(d8)>;
  Bytes low[3];
  Bytes high[3];
  hn::LoadInterleaved3(d8, reinterpret_cast<const std::uint8_t*>(least), low[0], low[1], low[2]);
  hn::LoadInterleaved3(d8, reinterpret_cast<const std::uint8_t*>(greatest), high[0], high[1],
                       high[2]);
  auto depth = hn::Zero(du);
  auto color = depth;
  auto far_depth = depth;
  auto far_color = depth;
  hn::LoadInterleaved2(du, reinterpret_cast<const std::uint32_t*>(nearest), depth, color);
  hn::LoadInterleaved2(du, reinterpret_cast<const std::uint32_t*>(farthest), far_depth, far_color);
  auto square = hn::Zero(di);
  auto far_square = hn::Zero(di);
  const auto byte = hn::Set(di, 255);
  const auto add_channel = [&](auto value, auto far_value, Bytes least_value,
                               Bytes greatest_value) HWY_ATTR {
    const auto from = hn::PromoteTo(di, least_value);
    const auto to = hn::PromoteTo(di, greatest_value);
    const auto beyond = [&](auto levels) HWY_ATTR {
      const auto own = hn::And(hn::BitCast(di, levels), byte);
      return hn::Max(hn::Zero(di), hn::Max(hn::Sub(from, own), hn::Sub(own, to)));
    };
    const auto by = beyond(value);
    const auto far_by = beyond(far_value);
    square = hn::Add(square, hn::Mul(by, by));
    far_square = hn::Add(far_square, hn::Mul(far_by, far_by));
  };
  add_channel(color, far_color, low[0], high[0]);
  add_channel(hn::ShiftRight<8>(color), hn::ShiftRight<8>(far_color), low[1], high[1]);
  add_channel(hn::ShiftRight<16>(color), hn::ShiftRight<16>(far_color), low[2], high[2]);
  const auto seen = hn::RebindMask(d, hn::Ne(hn::ShiftRight<24>(color), hn::Zero(du)));
  const auto one = hn::Set(d, 1.F);
  const auto apart = hn::Sub(one, hn::Div(hn::BitCast(d, depth), hn::BitCast(d, far_depth)));
  const auto is_one = hn::Lt(apart, hn::Set(d, two_surfaces));
  const auto near_by = hn::Sqrt(hn::ConvertTo(d, square));
  const auto far_by = hn::IfThenElse(is_one, near_by, hn::Sqrt(hn::ConvertTo(d, far_square)));
  const auto either = hn::Min(near_by, far_by);
  hn::StoreInterleaved3(hn::IfThenElseZero(seen, near_by), hn::IfThenElseZero(seen, far_by),
                        hn::IfThenElseZero(seen, either), d, reinterpret_cast<float*>(differences));
}

void CompareRow(const SeenSurface* nearest, const SeenSurface* farthest, const Bgr* least,
                const Bgr* greatest, int count, SurfaceDifference* differences) {
  const hn::CappedTag<float, 16> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    Compare(d, nearest + x, farthest + x, least + x, greatest + x, differences + x);
  }
  for (; x < count; ++x) {
    Compare(hn::CappedTag<float, 1>(), nearest + x, farthest + x, least + x, greatest + x,
            differences + x);
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(CompareRow);

}  // namespace

float color_difference(const Bgr& color, const Bgr& least, const Bgr& greatest) {
  const auto beyond = [](std::uint8_t value, std::uint8_t from, std::uint8_t to) {
    const int d = std::max({0, from - value, value - to});
    return d * d;
  };
  return std::sqrt(static_cast<float>(beyond(color.b, least.b, greatest.b) +
                                      beyond(color.g, least.g, greatest.g) +
                                      beyond(color.r, least.r, greatest.r)));
}

void compare_surfaces(const SeenSurface* nearest, const SeenSurface* farthest, const Bgr* least,
                      const Bgr* greatest, int count, SurfaceDifference* differences) {
  HWY_DYNAMIC_DISPATCH(CompareRow)(nearest, farthest, least, greatest, count, differences);
}

}  // namespace diminish
#endif
