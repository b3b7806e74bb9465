#include "core/even_color.h"

#include <algorithm>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/even_color.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR || HWY_HAVE_SCALABLE

EvenColor FindEvenColor(ImageView<Bgr> image, int x, int y) {
  return plain::even_color(image, x, y);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

/// A pixel is a vector of four bytes, of which the last is of no use.
EvenColor FindEvenColor(ImageView<Bgr> image, int x, int y) {
  constexpr int reach = even_color_reach_px;
  const hn::FixedTag<std::uint8_t, 4> bytes;
  const hn::FixedTag<std::uint16_t, 4> words;
  auto lowest = hn::Set(bytes, std::uint8_t{255});
  auto highest = hn::Zero(bytes);
  auto sum = hn::Zero(words);
  for (int dy = -reach; dy <= reach; dy += reach) {
    const auto* const row = reinterpret_cast<const std::uint8_t*>(image.row(y + dy) + x);
    const auto left = hn::LoadU(bytes, row - 3 * reach);
    const auto middle = hn::LoadU(bytes, row);
    // Nothing is read beyond the last pixel, which may be the image's.
    const hn::Repartition<std::uint32_t, decltype(bytes)> whole;
    const auto before = hn::BitCast(whole, hn::LoadU(bytes, row + 3 * reach - 1));
    const auto right = hn::BitCast(bytes, hn::ShiftRight<8>(before));
    lowest = hn::Min(hn::Min(lowest, left), hn::Min(middle, right));
    highest = hn::Max(hn::Max(highest, left), hn::Max(middle, right));
    sum = hn::Add(hn::Add(sum, hn::PromoteTo(words, left)),
                  hn::Add(hn::PromoteTo(words, middle), hn::PromoteTo(words, right)));
  }
  std::uint8_t ranges[4];
  std::uint16_t sums[4];
  hn::StoreU(hn::Sub(highest, lowest), bytes, ranges);
  hn::StoreU(sum, words, sums);
  EvenColor result;
  for (int c = 0; c < 3; ++c) result.channels[c] = static_cast<float>(sums[c]) / 9.F;
  result.even = std::max({ranges[0], ranges[1], ranges[2]}) <= even_color_range;
  return result;
}

#endif

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(FindEvenColor);

EvenColor even_color(ImageView<Bgr> image, int x, int y) {
  return HWY_DYNAMIC_DISPATCH(FindEvenColor)(image, x, y);
}

EvenColor plain::even_color(ImageView<Bgr> image, int x, int y) {
  constexpr int reach = even_color_reach_px;
  int sum[3] = {};
  int lowest[3] = {255, 255, 255};
  int highest[3] = {};
  for (int dy = -reach; dy <= reach; dy += reach) {
    const Bgr* row = image.row(y + dy) + x;
    for (int dx = -reach; dx <= reach; dx += reach) {
      const int levels[3] = {row[dx].b, row[dx].g, row[dx].r};
      for (int c = 0; c < 3; ++c) {
        sum[c] += levels[c];
        lowest[c] = std::min(lowest[c], levels[c]);
        highest[c] = std::max(highest[c], levels[c]);
      }
    }
  }
  EvenColor result;
  result.even = true;
  for (int c = 0; c < 3; ++c) {
    result.channels[c] = static_cast<float>(sum[c]) / 9.F;
    result.even = result.even && highest[c] - lowest[c] <= even_color_range;
  }
  return result;
}

}  // namespace diminish
#endif
