#include "render/texture_lookup.h"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/texture_lookup.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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
  float fx[most], fy[most];      ///< the place between four pixels of the texture
  std::int32_t place[most];      ///< of the upper left one, in bytes
  std::int32_t pixels[4][most];  ///< upper left, upper right, lower left, lower right
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
      const auto whole = hn::Min(hn::ConvertTo(di, value), hn::Set(di, side - 2));
      hn::StoreU(hn::Sub(value, hn::ConvertTo(d, whole)), d, fraction + i);
      return whole;
    };
    const auto x = place(row.u_over_z, texture.width(), places.fx);
    const auto y = place(row.v_over_z, texture.height(), places.fy);
    const auto row_bytes = hn::Set(di, static_cast<std::int32_t>(texture.stride()));
    hn::StoreU(hn::Add(hn::Mul(y, row_bytes), hn::Mul(x, hn::Set(di, 3))), di, places.place + i);
  });
}

/// Two neighbouring pixels with three bytes each.
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
  for (int i = 0; i < count; ++i) {
    const std::int32_t upper = places.place[i];
    const std::int32_t lower = upper + row_bytes;
    const std::int32_t from = std::min(lower, last);
    const std::uint64_t upper_pair = PixelPair(bytes, upper);
    const std::uint64_t lower_pair = PixelPair(bytes, from) >> (8 * (lower - from));
    places.pixels[0][i] = static_cast<std::int32_t>(upper_pair);
    places.pixels[1][i] = static_cast<std::int32_t>(upper_pair >> 24);
    places.pixels[2][i] = static_cast<std::int32_t>(lower_pair);
    places.pixels[3][i] = static_cast<std::int32_t>(lower_pair >> 24);
  }
}

template <int shift, class D>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> BlendChannel(D d, const Places& places, int i) {
  const hn::RebindToSigned<D> di;
  const auto value = [&](int pixel) HWY_ATTR {
    const auto bits = hn::ShiftRight<shift>(hn::LoadU(di, places.pixels[pixel] + i));
    return hn::ConvertTo(d, hn::And(bits, hn::Set(di, 255)));
  };
  const auto fx = hn::LoadU(d, places.fx + i);
  const auto fy = hn::LoadU(d, places.fy + i);
  const auto left = value(0);
  const auto lower_left = value(2);
  const auto top = hn::MulAdd(fx, hn::Sub(value(1), left), left);
  const auto bottom = hn::MulAdd(fx, hn::Sub(value(3), lower_left), lower_left);
  return hn::NearestInt(hn::MulAdd(fy, hn::Sub(bottom, top), top));
}

void LookUpColors(const SurfaceRow& row, ImageView<Bgr> texture, int width,
                  const std::uint8_t* source, const float* depth_m, Bgra* colors) {
  Places places;
  for (int first = 0; first < width; first += Places::most) {
    const int count = std::min(Places::most, width - first);
    if (std::find(source + first, source + first + count, row.source) == source + first + count) {
      continue;
    }
    FindPlaces(row, texture, first, count, depth_m, places);
    ReadPixels(texture, count, places);
    ForEachOverlappingVector(count, [&](auto d, int i) HWY_ATTR {
      const hn::RebindToSigned<decltype(d)> di;
      const hn::Rebind<std::uint8_t, decltype(d)> d8;
      const auto sources = hn::PromoteTo(di, hn::LoadU(d8, source + first + i));
      const auto mine = hn::Eq(sources, hn::Set(di, row.source));
      if (hn::AllFalse(di, mine)) return;
      const auto blue = BlendChannel<0>(d, places, i);
      const auto green = hn::ShiftLeft<8>(BlendChannel<8>(d, places, i));
      const auto red = hn::ShiftLeft<16>(BlendChannel<16>(d, places, i));
      const auto alpha = hn::Set(di, static_cast<std::int32_t>(0xFF000000U));
      const auto color = hn::Or(hn::Or(blue, green), hn::Or(red, alpha));
      auto* to = reinterpret_cast<std::int32_t*>(colors + first + i);
      hn::StoreU(hn::IfThenElse(mine, color, hn::LoadU(di, to)), di, to);
    });
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
