#include "core/extremum_filters.h"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/extremum_filters.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

struct Largest {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Max(a, b);
  }
};
struct Smallest {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Min(a, b);
  }
};

/// result[i] = the extremum of taps[0][i], taps[1][i] and so on.
template <class Choose>
HWY_INLINE void Combine(const std::uint8_t* const* taps, int tap_count, int count,
                        std::uint8_t* result) {
  const Choose choose;
  const auto combine = [&](auto d, int i) HWY_ATTR {
    auto value = hn::LoadU(d, taps[0] + i);
    for (int k = 1; k < tap_count; ++k) value = choose(value, hn::LoadU(d, taps[k] + i));
    hn::StoreU(value, d, result + i);
  };
  const hn::ScalableTag<std::uint8_t> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  if (count < lanes) {
    for (int i = 0; i < count; ++i) combine(hn::CappedTag<std::uint8_t, 1>(), i);
    return;
  }
  // Four vectors at a time: a tap is read once for all of them. The last ones overlap.
  const int last = count - lanes;
  for (int i = 0; i < count; i += 4 * lanes) {
    const int places[] = {std::min(i, last), std::min(i + lanes, last),
                          std::min(i + 2 * lanes, last), std::min(i + 3 * lanes, last)};
    const auto load = [&](int k, int part)
                          HWY_ATTR { return hn::LoadU(d, taps[k] + places[part]); };
    auto a = load(0, 0);
    auto b = load(0, 1);
    auto c = load(0, 2);
    auto e = load(0, 3);
    for (int k = 1; k < tap_count; ++k) {
      a = choose(a, load(k, 0));
      b = choose(b, load(k, 1));
      c = choose(c, load(k, 2));
      e = choose(e, load(k, 3));
    }
    hn::StoreU(a, d, result + places[0]);
    hn::StoreU(b, d, result + places[1]);
    hn::StoreU(c, d, result + places[2]);
    hn::StoreU(e, d, result + places[3]);
  }
}

void FindLargest(const std::uint8_t* const* taps, int tap_count, int count, std::uint8_t* result) {
  Combine<Largest>(taps, tap_count, count, result);
}
void FindSmallest(const std::uint8_t* const* taps, int tap_count, int count, std::uint8_t* result) {
  Combine<Smallest>(taps, tap_count, count, result);
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(FindLargest);
HWY_EXPORT(FindSmallest);

/// The rows, or the places in a row, whose extremum is wanted; a reach of 7 at most.
class Taps {
 public:
  void clear() { count_ = 0; }
  void push_back(const std::uint8_t* tap) { taps_.at(count_++) = tap; }
  const std::uint8_t* const* data() const { return taps_.data(); }
  int size() const { return static_cast<int>(count_); }

 private:
  std::array<const std::uint8_t*, 15> taps_;
  std::size_t count_ = 0;
};

void find_largest(const Taps& taps, int count, std::uint8_t* result) {
  HWY_DYNAMIC_DISPATCH(FindLargest)(taps.data(), taps.size(), count, result);
}
void find_smallest(const Taps& taps, int count, std::uint8_t* result) {
  HWY_DYNAMIC_DISPATCH(FindSmallest)(taps.data(), taps.size(), count, result);
}

/// First along columns, then along rows. Beyond a row's ends its outermost pixels are repeated,
/// which changes no extremum.
template <class Pixel, class Find>
void filter(const Image<Pixel>& image, const Reach& reach, const Find& find, Image<Pixel>& scratch,
            Image<Pixel>& result) {
  constexpr int channels = sizeof(Pixel);
  const auto bytes = [](auto* pixels) { return reinterpret_cast<std::uint8_t*>(pixels); };
  const int width = image.width();
  result.resize(width, image.height());
  scratch.resize(width + 2 * reach.x, 1);
  if (width == 0) return;
  Pixel* const line = scratch.row(0) + reach.x;
  Taps taps;
  for (int y = 0; y < image.height(); ++y) {
    taps.clear();
    const int last = std::min(y + reach.y, image.height() - 1);
    for (int row = std::max(y - reach.y, 0); row <= last; ++row) {
      taps.push_back(reinterpret_cast<const std::uint8_t*>(image.row(row)));
    }
    if (reach.x == 0) {
      find(taps, channels * width, bytes(result.row(y)));
      continue;
    }
    find(taps, channels * width, bytes(line));
    std::fill_n(line - reach.x, reach.x, line[0]);
    std::fill_n(line + width, reach.x, line[width - 1]);
    taps.clear();
    for (int shift = -reach.x; shift <= reach.x; ++shift) taps.push_back(bytes(line + shift));
    find(taps, channels * width, bytes(result.row(y)));
  }
}

}  // namespace

void dilate(const Mask& image, const Reach& reach, Mask& scratch, Mask& result) {
  filter(image, reach, find_largest, scratch, result);
}
void erode(const Mask& image, const Reach& reach, Mask& scratch, Mask& result) {
  filter(image, reach, find_smallest, scratch, result);
}
void dilate(const Image<Bgr>& image, const Reach& reach, Image<Bgr>& scratch, Image<Bgr>& result) {
  filter(image, reach, find_largest, scratch, result);
}
void erode(const Image<Bgr>& image, const Reach& reach, Image<Bgr>& scratch, Image<Bgr>& result) {
  filter(image, reach, find_smallest, scratch, result);
}

}  // namespace diminish
#endif
