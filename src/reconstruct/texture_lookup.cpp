#include "reconstruct/texture_lookup.h"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reconstruct/texture_lookup.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int block = 16;
using Floats = hn::CappedTag<float, block>;
using Ints = hn::RebindToSigned<Floats>;
using Vector = hn::Vec<Floats>;
using IntVector = hn::Vec<Ints>;

template <int channel>
HWY_INLINE Vector Channel(IntVector pixels) {
  return hn::ConvertTo(Floats(),
                       hn::And(hn::ShiftRight<8 * channel>(pixels), hn::Set(Ints(), 255)));
}

/// Blue, green and red of pixels in the lower three bytes. Four bytes are read at once, but not
/// beyond `last`. (On many processors the gather instruction is slower.)
HWY_INLINE IntVector Gather(const std::uint8_t* texture, IntVector at, std::int32_t last) {
  const Ints d;
  HWY_ALIGN std::int32_t places[block];
  HWY_ALIGN std::int32_t pixels[block];
  hn::Store(at, d, places);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
    const std::int32_t place = std::min(places[i], last);
    std::uint32_t pixel;
    std::memcpy(&pixel, texture + place, sizeof(pixel));
    pixels[i] = static_cast<std::int32_t>(pixel >> (8 * (places[i] - place)));
  }
  return hn::Load(d, pixels);
}

void LookUpRow(const SurfaceBuffer& surface, int y, const std::uint8_t* wanted,
               const Image<Bgr>& texture, Bgra* colors, float* depth_m) {
  const Floats d;
  const Ints di;
  const hn::Rebind<std::uint8_t, Floats> d8;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(texture.data());
  // The last place that four bytes can be read from.
  const auto last = static_cast<std::int32_t>(3 * texture.size()) - 4;
  const IntVector last_column = hn::Set(di, texture.width() - 1);
  const IntVector last_row = hn::Set(di, texture.height() - 1);
  HWY_ALIGN std::uint8_t padded_wanted[block];
  HWY_ALIGN Bgra padded_colors[block];
  HWY_ALIGN float padded_depth[block];
  const int count = surface.region.width;
  for (int i = 0; i < count; i += lanes) {
    const int here = std::min(lanes, count - i);
    const bool partial = here < lanes;
    const std::ptrdiff_t from = surface.row(y) + i;
    const std::uint8_t* wanted_here = wanted ? wanted + i : nullptr;
    Bgra* to = colors + i;
    float* to_depth = depth_m + i;
    if (partial) {
      if (wanted) {
        std::copy_n(wanted_here, here, padded_wanted);
        wanted_here = padded_wanted;
      }
      to = padded_colors;
      to_depth = padded_depth;
    }
    const Vector inverse_z = hn::LoadU(d, surface.inverse_z.data() + from);
    const Vector u_over_z = hn::LoadU(d, surface.u_over_z.data() + from);
    const Vector v_over_z = hn::LoadU(d, surface.v_over_z.data() + from);
    auto seen = hn::Gt(inverse_z, hn::Zero(d));
    if (wanted) {
      const IntVector flags = hn::PromoteTo(di, hn::LoadU(d8, wanted_here));
      seen = hn::And(seen, hn::RebindMask(d, hn::Ne(flags, hn::Zero(di))));
    }
    if (hn::AllFalse(d, seen)) {
      std::fill_n(to, lanes, Bgra{});
      std::fill_n(to_depth, lanes, 0.F);
    } else {
      const Vector z = hn::IfThenElseZero(seen, hn::Div(hn::Set(d, 1.F), inverse_z));
      const Vector u = hn::Max(hn::Mul(u_over_z, z), hn::Zero(d));
      const Vector v = hn::Max(hn::Mul(v_over_z, z), hn::Zero(d));
      const IntVector x0 = hn::Min(hn::ConvertTo(di, u), last_column);
      const IntVector y0 = hn::Min(hn::ConvertTo(di, v), last_row);
      const IntVector x1 = hn::Min(hn::Add(x0, hn::Set(di, 1)), last_column);
      const IntVector y1 = hn::Min(hn::Add(y0, hn::Set(di, 1)), last_row);
      const Vector fx = hn::Sub(u, hn::ConvertTo(d, x0));
      const Vector fy = hn::Sub(v, hn::ConvertTo(d, y0));
      const IntVector row_bytes = hn::Set(di, 3 * texture.width());
      const auto offset = [&](IntVector column, IntVector line) HWY_ATTR {
        return hn::Add(hn::Mul(line, row_bytes), hn::Mul(column, hn::Set(di, 3)));
      };
      const IntVector p00 = Gather(bytes, offset(x0, y0), last);
      const IntVector p10 = Gather(bytes, offset(x1, y0), last);
      const IntVector p01 = Gather(bytes, offset(x0, y1), last);
      const IntVector p11 = Gather(bytes, offset(x1, y1), last);
      const auto blend = [&](Vector q00, Vector q10, Vector q01, Vector q11) HWY_ATTR {
        const Vector top = hn::MulAdd(fx, hn::Sub(q10, q00), q00);
        const Vector bottom = hn::MulAdd(fx, hn::Sub(q11, q01), q01);
        return hn::NearestInt(hn::MulAdd(fy, hn::Sub(bottom, top), top));
      };
      const IntVector blue =
          blend(Channel<0>(p00), Channel<0>(p10), Channel<0>(p01), Channel<0>(p11));
      const IntVector green =
          blend(Channel<1>(p00), Channel<1>(p10), Channel<1>(p01), Channel<1>(p11));
      const IntVector red =
          blend(Channel<2>(p00), Channel<2>(p10), Channel<2>(p01), Channel<2>(p11));
      const IntVector color = hn::Or(
          hn::Or(blue, hn::ShiftLeft<8>(green)),
          hn::Or(hn::ShiftLeft<16>(red), hn::Set(di, static_cast<std::int32_t>(0xFF000000U))));
      hn::StoreU(hn::IfThenElseZero(hn::RebindMask(di, seen), color), di,
                 reinterpret_cast<std::int32_t*>(to));
      hn::StoreU(z, d, to_depth);
    }
    if (partial) {
      std::copy_n(padded_colors, here, colors + i);
      std::copy_n(padded_depth, here, depth_m + i);
    }
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(LookUpRow);

void look_up_row(const SurfaceBuffer& surface, int y, const std::uint8_t* wanted,
                 const Image<Bgr>& texture, Bgra* colors, float* depth_m) {
  HWY_DYNAMIC_DISPATCH(LookUpRow)(surface, y, wanted, texture, colors, depth_m);
}

}  // namespace diminish
#endif
