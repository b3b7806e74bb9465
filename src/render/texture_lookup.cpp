#include "render/texture_lookup.h"

#include <algorithm>
#include <cstring>

#include "core/runs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/texture_lookup.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/small_numbers-inl.h"
#include "depth/row_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

void ChooseSource(const std::vector<SurfaceRow>& rows, float agreement_m, int width,
                  std::uint8_t* source, float* depth_m) {
  ForEachOverlappingVector(width, [&](auto d, int i) HWY_ATTR {
    const hn::RebindToSigned<decltype(d)> di;
    const auto agreement = hn::Set(d, agreement_m);
    auto nearest = hn::Zero(d);
    auto chosen = hn::Zero(di);
    for (const SurfaceRow& row : rows) {
      const auto inverse_z = hn::LoadU(d, row.inverse_z + i);
      const auto there = hn::Gt(inverse_z, hn::Zero(d));
      if (hn::AllFalse(d, there)) continue;
      const auto z = hn::IfThenElseZero(there, hn::Div(hn::Set(d, 1.F), inverse_z));
      const auto nearer = hn::And(
          there, hn::Or(hn::Eq(nearest, hn::Zero(d)), hn::Lt(z, hn::Sub(nearest, agreement))));
      nearest = hn::IfThenElse(nearer, z, nearest);
      chosen = hn::IfThenElse(hn::RebindMask(di, nearer), hn::Set(di, row.source), chosen);
    }
    hn::StoreU(nearest, d, depth_m + i);
    StoreBytes(d, chosen, source + i);
  });
}

/// Some neighbouring pixels of a row. Each step of the lookup runs over all of them before the next
/// step begins, so that no vector is read back while its parts are being written. (On many CPUs
/// gather instructions are slower.)
struct alignas(64) Places {
  static constexpr int most = 128;
  float fx[most], fy[most];                ///< the place between four pixels of the texture
  std::int32_t place[most];                ///< of the upper left one, in bytes
  std::uint64_t upper[most], lower[most];  ///< two neighbouring pixels with three bytes each
};

HWY_INLINE void FindPlaces(const SurfaceRow& row, ImageView<Bgr> texture, int first, int count,
                           const float* depth_m, Places& places) {
  ForEachOverlappingVector(count, [&](auto d, int i) HWY_ATTR {
    const hn::RebindToSigned<decltype(d)> di;
    const auto zero = hn::Zero(d);
    const auto z = hn::LoadU(d, depth_m + first + i);
    // Pixels outside belong to another camera.
    const auto place = [&](const float* over_z, int side, float* fraction) HWY_ATTR {
      const auto last = hn::Set(d, static_cast<float>(side - 1));
      const auto value = hn::Min(hn::Max(hn::Mul(hn::LoadU(d, over_z + first + i), z), zero), last);
      // The last pixel is the second one of a pair.
      const auto whole = hn::Min(TruncateSmall(value), hn::Set(di, side - 2));
      hn::StoreU(hn::Sub(value, hn::ConvertTo(d, whole)), d, fraction + i);
      return whole;
    };
    const auto x = place(row.u_over_z, texture.width(), places.fx);
    const auto y = place(row.v_over_z, texture.height(), places.fy);
    const auto row_bytes = hn::Set(di, static_cast<std::int32_t>(texture.stride()));
    hn::StoreU(hn::Add(hn::Mul(y, row_bytes), hn::Mul(x, hn::Set(di, 3))), di, places.place + i);
  });
}

HWY_INLINE std::uint64_t PixelPair(const std::uint8_t* texture, std::int32_t place) {
  std::uint64_t pair;
  std::memcpy(&pair, texture + place, sizeof(pair));
  return pair;
}

HWY_INLINE void ReadPixels(ImageView<Bgr> texture, int count, Places& places) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(texture.data());
  const auto row_bytes = static_cast<std::int32_t>(texture.stride());
  // The last place from which eight bytes can be read.
  const auto last = (texture.height() - 1) * row_bytes + 3 * texture.width() - 8;
  std::int32_t greatest = 0;
  for (int i = 0; i < count; ++i) greatest = std::max(greatest, places.place[i]);
  if (greatest + row_bytes <= last) {
    for (int i = 0; i < count; ++i) {
      places.upper[i] = PixelPair(bytes, places.place[i]);
      places.lower[i] = PixelPair(bytes + row_bytes, places.place[i]);
    }
    return;
  }
  for (int i = 0; i < count; ++i) {
    const std::int32_t lower = places.place[i] + row_bytes;
    const std::int32_t from = std::min(lower, last);
    places.upper[i] = PixelPair(bytes, places.place[i]);
    places.lower[i] = PixelPair(bytes, from) >> (8 * (lower - from));
  }
}

/// A vector of left and one of right pixels; their highest bytes are of no use.
template <class D>
struct PixelPairs {
  using Ints = hn::RebindToSigned<D>;
  hn::Vec<Ints> left, right;

  HWY_INLINE PixelPairs(D /*d*/, const std::uint64_t* pairs) {
    const Ints ints;
#if HWY_TARGET != HWY_SCALAR
    if constexpr (hn::MaxLanes(D()) > 1) {
      const hn::Repartition<std::uint64_t, Ints> d64;
      const auto first = hn::LoadU(d64, pairs);
      const auto second = hn::LoadU(d64, pairs + hn::Lanes(d64));
      const auto low = [&](auto low_half, auto high_half) HWY_ATTR {
        return hn::ConcatEven(ints, hn::BitCast(ints, high_half), hn::BitCast(ints, low_half));
      };
      left = low(first, second);
      right = low(hn::ShiftRight<24>(first), hn::ShiftRight<24>(second));
      return;
    }
#endif
    left = hn::Set(ints, static_cast<std::int32_t>(*pairs));
    right = hn::Set(ints, static_cast<std::int32_t>(*pairs >> 24));
  }
  template <int shift>
  HWY_INLINE static hn::Vec<D> Channel(hn::Vec<Ints> pixels) {
    const auto bits = hn::ShiftRight<shift>(pixels);
    return hn::ConvertTo(D(), hn::And(bits, hn::Set(Ints(), 255)));
  }
  template <int shift>
  HWY_INLINE hn::Vec<D> Between(hn::Vec<D> fx) const {
    const auto from = Channel<shift>(left);
    return hn::MulAdd(fx, hn::Sub(Channel<shift>(right), from), from);
  }
};

void LookUpColors(const SurfaceRow& row, ImageView<Bgr> texture, int width,
                  const std::uint8_t* source, const float* depth_m, Bgra* colors) {
  Places places;
  // Pixels of other cameras between the row's own are looked up, too, if they are few.
  constexpr int most_between = 16;
  for (int first = 0; (first = find_equal(source, first, width, row.source)) < width;) {
    const int room = std::min(first + Places::most, width);
    int end = find_other(source, first, room, row.source);
    for (int next; end < room; end = find_other(source, next, room, row.source)) {
      next = find_equal(source, end, room, row.source);
      if (next == room || next - end > most_between) break;
    }
    const int count = end - first;
    FindPlaces(row, texture, first, count, depth_m, places);
    ReadPixels(texture, count, places);
    ForEachOverlappingVector(count, [&](auto d, int i) HWY_ATTR {
      const hn::RebindToSigned<decltype(d)> di;
      const hn::Rebind<std::uint8_t, decltype(d)> d8;
      const auto sources = hn::PromoteTo(di, hn::LoadU(d8, source + first + i));
      const auto mine = hn::Eq(sources, hn::Set(di, row.source));
      if (hn::AllFalse(di, mine)) return;
      const PixelPairs<decltype(d)> upper(d, places.upper + i);
      const PixelPairs<decltype(d)> lower(d, places.lower + i);
      const auto fx = hn::LoadU(d, places.fx + i);
      const auto fy = hn::LoadU(d, places.fy + i);
      const auto mix = [&](auto top, auto bottom) HWY_ATTR {
        return NearestSmall(hn::MulAdd(fy, hn::Sub(bottom, top), top));
      };
      const auto blue = mix(upper.template Between<0>(fx), lower.template Between<0>(fx));
      const auto green =
          hn::ShiftLeft<8>(mix(upper.template Between<8>(fx), lower.template Between<8>(fx)));
      const auto red =
          hn::ShiftLeft<16>(mix(upper.template Between<16>(fx), lower.template Between<16>(fx)));
      const auto alpha = hn::Set(di, static_cast<std::int32_t>(0xFF000000U));
      const auto color = hn::Or(hn::Or(blue, green), hn::Or(red, alpha));
      auto* to = reinterpret_cast<std::int32_t*>(colors + first + i);
      hn::StoreU(hn::IfThenElse(mine, color, hn::LoadU(di, to)), di, to);
    });
    first = end;
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(ChooseSource);
HWY_EXPORT(LookUpColors);

void choose_source(const std::vector<SurfaceRow>& rows, float agreement_m, int width,
                   std::uint8_t* source, float* depth_m) {
  HWY_DYNAMIC_DISPATCH(ChooseSource)(rows, agreement_m, width, source, depth_m);
}

void look_up_colors(const SurfaceRow& row, ImageView<Bgr> texture, int width,
                    const std::uint8_t* source, const float* depth_m, Bgra* colors) {
  HWY_DYNAMIC_DISPATCH(LookUpColors)(row, texture, width, source, depth_m, colors);
}

}  // namespace diminish
#endif
