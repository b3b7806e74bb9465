#include "composite/mix_inventions.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>

#include "diminish/diminished_frame.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "composite/mix_inventions.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

void KeepInventions(const Bgr* colors, const std::uint8_t* origin, int count, Bgra* kept) {
  const hn::ScalableTag<std::uint8_t> d;
  const auto* const from = reinterpret_cast<const std::uint8_t*>(colors);
  auto* const to = reinterpret_cast<std::uint8_t*>(kept);
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    hn::Vec<decltype(d)> blue, green, red;
    hn::LoadInterleaved3(d, from + std::ptrdiff_t{3} * x, blue, green, red);
    const auto from_where = hn::LoadU(d, origin + x);
    const auto is_invented = hn::Or(hn::Eq(from_where, hn::Set(d, provenance::inpainted)),
                                    hn::Eq(from_where, hn::Set(d, provenance::estimated)));
    hn::StoreInterleaved4(blue, green, red, hn::VecFromMask(d, is_invented), d,
                          to + std::ptrdiff_t{4} * x);
  }
  for (; x < count; ++x) {
    const bool is_invented =
        origin[x] == provenance::inpainted || origin[x] == provenance::estimated;
    kept[x] = {colors[x].b, colors[x].g, colors[x].r,
               static_cast<std::uint8_t>(is_invented ? 255 : 0)};
  }
}

void MixInventions(const EarlierInventions& earlier, const InventionRun& run, int earlier_share,
                   Bgr* colors) {
  static_assert(sizeof(Bgra) == sizeof(std::int32_t));
  const hn::CappedTag<float, InventionRun::most> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const Rect& part = earlier.part;
  const int pitch = earlier.picture.width();
  const auto* const upper =
      reinterpret_cast<const std::int32_t*>(earlier.picture.row(part.y) + part.x);
  const auto* const lower = upper + pitch;
  const auto share = hn::Set(di, earlier_share);
  const auto low_byte = hn::Set(di, 255);

  // Whole vectors are read and written.
  std::array<Bgr, InventionRun::most> padded;
  std::copy_n(colors, run.count, padded.data());
  for (int i = 0; i < run.count; i += static_cast<int>(hn::Lanes(d))) {
    const auto index = hn::Iota(d, static_cast<float>(i));
    const auto place = [&](float first, float step) HWY_ATTR {
      const auto at = hn::Add(hn::Set(d, first), hn::Mul(index, hn::Set(d, step)));
      return hn::NearestInt(hn::Mul(at, hn::Set(d, 256.F)));
    };
    const auto x = place(run.first.x(), run.step.x());
    const auto y = place(run.first.y(), run.step.y());
    const auto column = hn::Sub(hn::ShiftRight<8>(x), hn::Set(di, part.x));
    const auto row = hn::Sub(hn::ShiftRight<8>(y), hn::Set(di, part.y));
    const auto is_before = [&](auto value, int end) HWY_ATTR {
      return hn::AndNot(hn::Lt(value, hn::Zero(di)), hn::Lt(value, hn::Set(di, end)));
    };
    // With the next column and row.
    const auto is_inside =
        hn::And(is_before(column, part.width - 1), is_before(row, part.height - 1));
    if (hn::AllFalse(di, is_inside)) continue;
    const auto offset =
        hn::IfThenElseZero(is_inside, hn::Add(hn::Mul(row, hn::Set(di, pitch)), column));
    const auto upper_left = hn::GatherIndex(di, upper, offset);
    const auto upper_right = hn::GatherIndex(di, upper + 1, offset);
    const auto lower_left = hn::GatherIndex(di, lower, offset);
    const auto lower_right = hn::GatherIndex(di, lower + 1, offset);
    // An alpha of 255 is a sign.
    const auto are_invented = hn::Lt(
        hn::And(hn::And(upper_left, upper_right), hn::And(lower_left, lower_right)), hn::Zero(di));
    const auto is_mixed = hn::And(is_inside, are_invented);
    if (hn::AllFalse(di, is_mixed)) continue;

    const auto right = hn::And(x, low_byte);
    const auto down = hn::And(y, low_byte);
    const auto mix = [&](auto channel, hn::Vec<decltype(bytes)>& level) HWY_ATTR {
      constexpr int bit = 8 * decltype(channel)::value;
      const auto level_of = [&](auto pixels)
                                HWY_ATTR { return hn::And(hn::ShiftRight<bit>(pixels), low_byte); };
      // a + share * (b - a), times 256
      const auto between = [&](auto a, auto b, auto share_of_b) HWY_ATTR {
        return hn::Add(hn::ShiftLeft<8>(a), hn::Mul(share_of_b, hn::Sub(b, a)));
      };
      const auto above = between(level_of(upper_left), level_of(upper_right), right);
      const auto below = between(level_of(lower_left), level_of(lower_right), right);
      const auto before = hn::ShiftRight<8>(between(above, below, down));
      const auto now = hn::PromoteTo(di, level);
      const auto both = between(hn::ShiftLeft<8>(now), before, share);
      const auto mixed = hn::ShiftRight<16>(hn::Add(both, hn::Set(di, 1 << 15)));
      level = hn::DemoteTo(bytes, hn::IfThenElse(is_mixed, mixed, now));
    };
    auto* const own = reinterpret_cast<std::uint8_t*>(padded.data() + i);
    hn::Vec<decltype(bytes)> blue, green, red;
    hn::LoadInterleaved3(bytes, own, blue, green, red);
    mix(std::integral_constant<int, 0>(), blue);
    mix(std::integral_constant<int, 1>(), green);
    mix(std::integral_constant<int, 2>(), red);
    hn::StoreInterleaved3(blue, green, red, bytes, own);
  }
  std::copy_n(padded.data(), run.count, colors);
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

namespace {

HWY_EXPORT(KeepInventions);
HWY_EXPORT(MixInventions);

}  // namespace

void keep_inventions(const Bgr* colors, const std::uint8_t* provenance, int count, Bgra* kept) {
  HWY_DYNAMIC_DISPATCH(KeepInventions)(colors, provenance, count, kept);
}
void mix_inventions(const EarlierInventions& earlier, const InventionRun& run, int earlier_share,
                    Bgr* colors) {
  HWY_DYNAMIC_DISPATCH(MixInventions)(earlier, run, earlier_share, colors);
}

}  // namespace diminish
#endif
