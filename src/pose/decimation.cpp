#include "pose/decimation.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pose/decimation.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int step = 3 * decimation;

#if HWY_TARGET != HWY_SCALAR
/// The sums of neighbouring numbers: half as many, twice as wide.
template <class D, class Wide, class V>
HWY_INLINE hn::Vec<Wide> AddPairs(D /*of the numbers*/, Wide wide, V numbers) {
  constexpr int bits = 8 * sizeof(hn::TFromD<D>);
  const auto both = hn::BitCast(wide, numbers);
  const auto even = hn::And(both, hn::Set(wide, static_cast<hn::TFromD<Wide>>((1U << bits) - 1U)));
  return hn::Add(even, hn::ShiftRight<bits>(both));
}

/// The whole vectors of DecimateRow. Returns their number of pixels.
HWY_INLINE int DecimateVectors(const std::uint8_t* upper, const std::uint8_t* lower, int count,
                               std::uint8_t* means) {
  const hn::ScalableTag<std::uint8_t> d;
  const hn::RepartitionToWide<decltype(d)> d16;
  const hn::RepartitionToWide<decltype(d16)> d32;
  const hn::RebindToSigned<decltype(d32)> i32;
  const hn::Rebind<std::uint8_t, decltype(d32)> d8;
  const auto at_once = static_cast<int>(hn::Lanes(d32));
  const auto pairs_of = [&](const std::uint8_t* row) HWY_ATTR {
    hn::Vec<decltype(d)> blue, green, red;
    hn::LoadInterleaved3(d, row, blue, green, red);
    return AddPairs(d, d16, green);
  };
  int x = 0;
  for (; x + at_once <= count; x += at_once) {
    const auto pairs = hn::Add(pairs_of(upper + step * x), pairs_of(lower + step * x));
    const auto sums = hn::Add(AddPairs(d16, d32, pairs), hn::Set(d32, 4));
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(i32, hn::ShiftRight<3>(sums))), d8, means + x);
  }
  return x;
}
#endif

/// The rounded means of 4x2 pixels' green channel (the other channels add little).
void DecimateRow(const std::uint8_t* upper, const std::uint8_t* lower, int count,
                 std::uint8_t* means) {
  int x = 0;
#if HWY_TARGET != HWY_SCALAR
  x = DecimateVectors(upper, lower, count, means);
#endif
  for (; x < count; ++x) {
    int sum = 4;
    for (int i = 0; i < decimation; ++i) {
      sum += upper[step * x + 3 * i + 1] + lower[step * x + 3 * i + 1];
    }
    means[x] = static_cast<std::uint8_t>(sum >> 3);
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(DecimateRow);

}  // namespace

void decimate(const Image<Bgr>& image, Image<std::uint8_t>& small) {
  small.resize(image.width() / decimation, image.height() / decimation);
  for (int y = 0; y < small.height(); ++y) {
    // Two of the four rows: half the memory, and noise does no harm here.
    HWY_DYNAMIC_DISPATCH(DecimateRow)
    (reinterpret_cast<const std::uint8_t*>(image.row(decimation * y + 1)),
     reinterpret_cast<const std::uint8_t*>(image.row(decimation * y + 2)), small.width(),
     small.row(y));
  }
}

}  // namespace diminish
#endif
