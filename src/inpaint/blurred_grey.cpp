#include "inpaint/blurred_grey.h"

#include <algorithm>
#include <array>
#include <cstddef>

#ifndef DIMINISH_INPAINT_BLURRED_GREY_TILES
#define DIMINISH_INPAINT_BLURRED_GREY_TILES
namespace diminish {
namespace {

constexpr int radius = 2;  ///< of the blur, by 1 4 6 4 1
/// With its surroundings a tile is a whole number of vectors wide.
constexpr int tile = 28;
constexpr int wide = tile + 2 * radius;
/// Of a row's vectors that are loaded from the third and fourth column on, beyond its end.
constexpr int ahead = 16;

using GreyRow = std::uint16_t[wide + ahead];

}  // namespace
}  // namespace diminish
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "inpaint/blurred_grey.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Levels = hn::CappedTag<std::uint16_t, ahead>;

/// colors: `wide` pixels.
void FindGrey(const std::uint8_t* colors, std::uint16_t* grey) {
  const Levels d;
  const hn::Rebind<std::uint8_t, Levels> d8;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < wide; x += lanes) {
    hn::Vec<decltype(d8)> blue;
    hn::Vec<decltype(d8)> green;
    hn::Vec<decltype(d8)> red;
    hn::LoadInterleaved3(d8, colors + std::ptrdiff_t{3} * x, blue, green, red);
    const auto weighted = [&](auto channel, int weight) HWY_ATTR {
      return hn::Mul(hn::PromoteTo(d, channel), hn::Set(d, static_cast<std::uint16_t>(weight)));
    };
    const auto sum = hn::Add(hn::Add(weighted(blue, 29), weighted(green, 150)),
                             hn::Add(weighted(red, 77), hn::Set(d, std::uint16_t{128})));
    hn::Store(hn::ShiftRight<8>(sum), d, grey + x);
  }
}

/// 1 4 6 4 1 of five vectors.
template <class V>
V Weigh(V a, V b, V c, V d, V e) {
  const auto twice_c = hn::Add(c, c);
  const auto sides = hn::Add(hn::Add(b, d), c);
  return hn::Add(hn::Add(hn::Add(a, e), twice_c), hn::ShiftLeft<2>(sides));
}

/// Rows of `wide` levels to rows of a tile's.
void BlurAcross(GreyRow* rows, int count) {
  const Levels d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int k = 0; k < count; ++k) {
    std::uint16_t* const row = rows[k];
    for (int x = 0; x < tile; x += lanes) {
      const auto at = [&](int i) HWY_ATTR { return hn::LoadU(d, row + x + i); };
      hn::Store(Weigh(hn::Load(d, row + x), at(1), at(2), at(3), at(4)), d, row + x);
    }
  }
}

void BlurDown(const GreyRow* rows, int width, std::uint16_t* out) {
  const Levels d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < width; x += lanes) {
    const auto at = [&](int i) HWY_ATTR { return hn::Load(d, rows[i] + x); };
    const auto blurred = Weigh(at(0), at(1), at(2), at(3), at(4));
    if (x + lanes <= width) {
      hn::StoreU(blurred, d, out + x);
    } else {
      hn::BlendedStore(blurred, hn::FirstN(d, static_cast<std::size_t>(width - x)), d, out + x);
    }
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(FindGrey);
HWY_EXPORT(BlurAcross);
HWY_EXPORT(BlurDown);

}  // namespace

void BlurredGrey::begin(ImageView<Bgr> picture, const Rect& part) {
  picture_ = picture;
  part_ = part;
  levels_.resize(part.width, part.height);
  is_blurred_.resize((part.width + tile - 1) / tile, (part.height + tile - 1) / tile, 0);
}

void BlurredGrey::look_at(const Rect& pixels) {
  const Rect inside = intersect(pixels, levels_.bounds());
  if (inside.empty()) return;
  for (int row = inside.y / tile; row <= (inside.bottom() - 1) / tile; ++row) {
    for (int column = inside.x / tile; column <= (inside.right() - 1) / tile; ++column) {
      if (is_blurred_(column, row) != 0) continue;
      is_blurred_(column, row) = 1;
      blur(intersect({column * tile, row * tile, tile, tile}, levels_.bounds()));
    }
  }
}

void BlurredGrey::blur(const Rect& pixels) {
  alignas(64) GreyRow rows[wide];
  const int first = pixels.x - radius;
  const bool is_inside = first >= 0 && first + wide <= part_.width;
  std::array<Bgr, wide> clamped;
  for (int k = 0; k < pixels.height + 2 * radius; ++k) {
    const int y = std::clamp(pixels.y - radius + k, 0, part_.height - 1);
    const Bgr* colors = picture_.row(part_.y + y) + part_.x;
    if (is_inside) {
      colors += first;
    } else {
      for (int x = 0; x < wide; ++x) {
        clamped[static_cast<std::size_t>(x)] = colors[std::clamp(first + x, 0, part_.width - 1)];
      }
      colors = clamped.data();
    }
    HWY_DYNAMIC_DISPATCH(FindGrey)(&colors->b, rows[k]);
  }
  HWY_DYNAMIC_DISPATCH(BlurAcross)(rows, pixels.height + 2 * radius);
  for (int y = 0; y < pixels.height; ++y) {
    HWY_DYNAMIC_DISPATCH(BlurDown)
    (rows + y, pixels.width, levels_.row(pixels.y + y) + pixels.x);
  }
}

}  // namespace diminish
#endif
