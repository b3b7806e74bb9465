#include "pose/profile.h"

#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pose/profile.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// levels: of the green channel, bilinear.
void SampleProfile(ImageView<Bgr> image, const Profile& profile, float* levels) {
  const hn::CappedTag<float, 8> d;
  const hn::RebindToSigned<decltype(d)> di;
  const auto stride = static_cast<std::int32_t>(image.stride());
  // Four bytes from a pixel's green on end with the next pixel's.
  const auto* const upper = reinterpret_cast<const std::uint8_t*>(image.data()) + 1;
  const auto pixels = [&](const std::uint8_t* row, hn::Vec<decltype(di)> offset) HWY_ATTR {
    return hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(row), offset);
  };
  const auto between = [&](hn::Vec<decltype(di)> pair, hn::Vec<decltype(d)> share) HWY_ATTR {
    const hn::RebindToUnsigned<decltype(di)> bits;
    const auto left = hn::And(pair, hn::Set(di, 255));
    const auto right = hn::BitCast(di, hn::ShiftRight<24>(hn::BitCast(bits, pair)));
    return hn::Add(hn::ConvertTo(d, left), hn::Mul(share, hn::ConvertTo(d, hn::Sub(right, left))));
  };
  for (int i = 0; i < profile.count; i += static_cast<int>(hn::Lanes(d))) {
    const auto t = hn::Min(hn::Iota(d, static_cast<float>(i)),
                           hn::Set(d, static_cast<float>(profile.count - 1)));
    const auto x = hn::Add(hn::Set(d, profile.x), hn::Mul(t, hn::Set(d, profile.step_x)));
    const auto y = hn::Add(hn::Set(d, profile.y), hn::Mul(t, hn::Set(d, profile.step_y)));
    const auto column = hn::ConvertTo(di, x);
    const auto row = hn::ConvertTo(di, y);
    const auto right = hn::Sub(x, hn::ConvertTo(d, column));
    const auto down = hn::Sub(y, hn::ConvertTo(d, row));
    const auto offset = hn::Add(hn::Mul(row, hn::Set(di, stride)), hn::Mul(column, hn::Set(di, 3)));
    const auto top = between(pixels(upper, offset), right);
    const auto bottom = between(pixels(upper + stride, offset), right);
    hn::StoreU(hn::Add(top, hn::Mul(down, hn::Sub(bottom, top))), d, levels + i);
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(SampleProfile);

void sample_profile(ImageView<Bgr> image, const Profile& profile, float* levels) {
  HWY_DYNAMIC_DISPATCH(SampleProfile)(image, profile, levels);
}

}  // namespace diminish
#endif
