#include "blend/blend_row.h"

#include "blend/layers.h"
#include "depth/depth_noise.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "blend/blend_row.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "depth/row_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// The depth of pixels where there is nothing.
constexpr float beyond_m = 1e9F;

/// One camera's surface in a vector of pixels.
template <class D>
struct Surface {
  hn::Mask<D> there;
  hn::Vec<D> z, noise;

  HWY_INLINE Surface(D d, const BlendedRow& row, int i) {
    const auto inverse_z = hn::LoadU(d, row.inverse_z + i);
    there = hn::Gt(inverse_z, hn::Zero(d));
    z = hn::IfThenElse(there, hn::Div(hn::Set(d, 1.F), inverse_z), hn::Set(d, beyond_m));
    // Not fused: every kind of CPU rounds alike.
    const auto slope =
        hn::Add(hn::Mul(hn::Iota(d, static_cast<float>(i)), hn::Set(d, row.depth_step)),
                hn::Set(d, row.depth_slope));
    const auto depth = hn::Sub(hn::Mul(z, slope), hn::Set(d, row.depth_offset_m));
    noise = NoiseAt(d, DepthNoise(), depth);
  }
};

/// The nearest surface; see agreement_tolerance_m (camera_place.h).
template <class D>
struct Front {
  hn::Vec<D> z, noise;
  hn::Mask<D> several;  ///< more than one

  HWY_INLINE Front(D d, const std::vector<BlendedRow>& rows, int i)
      : z(hn::Set(d, beyond_m)), noise(hn::Zero(d)), several(hn::Lt(z, z)) {
    for (const BlendedRow& row : rows) {
      const Surface<D> surface(d, row, i);
      several = hn::Or(several, hn::And(surface.there, hn::Lt(z, hn::Set(d, beyond_m))));
      const auto nearer = hn::Lt(surface.z, z);
      z = hn::IfThenElse(nearer, surface.z, z);
      noise = hn::IfThenElse(nearer, surface.noise, noise);
    }
  }
  HWY_INLINE hn::Mask<D> IsSeenBy(D d, const Surface<D>& surface, float agreement_m) const {
    const auto tolerance = hn::Max(hn::Set(d, agreement_m), hn::Add(surface.noise, noise));
    return hn::And(surface.there, hn::Le(hn::Sub(surface.z, z), tolerance));
  }
};

template <class DI>
HWY_INLINE hn::Mask<DI> HasOneBitAtMost(DI di, hn::Vec<DI> bits) {
  return hn::Eq(hn::And(bits, hn::Sub(bits, hn::Set(di, 1))), hn::Zero(di));
}

void FindSeen(const std::vector<BlendedRow>& rows, float agreement_m, int width, std::uint8_t* seen,
              std::uint8_t* lone) {
  ForEachOverlappingVector(width, [&](auto d, int i) HWY_ATTR {
    const hn::RebindToSigned<decltype(d)> di;
    const Front<decltype(d)> front(d, rows, i);
    auto bits = hn::Zero(di);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const auto is_seen = front.IsSeenBy(d, Surface<decltype(d)>(d, rows[k], i), agreement_m);
      bits = hn::Or(bits, hn::IfThenElseZero(hn::RebindMask(di, is_seen), hn::Set(di, 1 << k)));
    }
    StoreBytes(d, bits, seen + i);
    const auto is_lone = hn::And(hn::RebindMask(di, front.several), HasOneBitAtMost(di, bits));
    StoreBytes(d, hn::IfThenElseZero(is_lone, hn::Set(di, 255)), lone + i);
  });
}

/// The pixels that at most one camera sees.
template <class D>
HWY_INLINE void StoreOnlySource(D d, const std::vector<BlendedRow>& rows, int i,
                                hn::Vec<hn::RebindToSigned<D>> bits, const TwoSources& out) {
  const hn::RebindToSigned<D> di;
  auto z = hn::Zero(d);
  auto source = hn::Zero(di);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto is_seen = hn::Ne(hn::And(bits, hn::Set(di, 1 << k)), hn::Zero(di));
    source = hn::IfThenElse(is_seen, hn::Set(di, rows[k].source), source);
    z = hn::IfThenElse(hn::RebindMask(d, is_seen), hn::LoadU(d, rows[k].inverse_z + i), z);
  }
  const auto is_any = hn::Gt(z, hn::Zero(d));
  hn::StoreU(hn::IfThenElseZero(is_any, hn::Div(hn::Set(d, 1.F), z)), d, out.depth_m + i);
  hn::StoreU(hn::Zero(d), d, out.second_depth_m + i);
  StoreBytes(d, source, out.source + i);
  StoreBytes(d, hn::Zero(di), out.second_source + i);
  StoreBytes(d, hn::Zero(di), out.share + i);
}

void ChooseTwo(const std::vector<BlendedRow>& rows, int width, const std::uint8_t* seen,
               const TwoSources& out) {
  ForEachOverlappingVector(width, [&](auto d, int i) HWY_ATTR {
    using D = decltype(d);
    const hn::RebindToSigned<D> di;
    const hn::Rebind<std::uint8_t, D> d8;
    const auto bits = hn::PromoteTo(di, hn::LoadU(d8, seen + i));
    if (hn::AllTrue(di, HasOneBitAtMost(di, bits))) {
      StoreOnlySource(d, rows, i, bits, out);
      return;
    }
    const auto zero = hn::Zero(d);
    auto first = zero, second = zero, third = zero;
    auto first_z = zero, second_z = zero;
    auto first_source = hn::Zero(di), second_source = hn::Zero(di);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const BlendedRow& row = rows[k];
      const auto is_seen =
          hn::RebindMask(d, hn::Ne(hn::And(bits, hn::Set(di, 1 << k)), hn::Zero(di)));
      const auto z =
          hn::IfThenElseZero(is_seen, hn::Div(hn::Set(d, 1.F), hn::LoadU(d, row.inverse_z + i)));
      const auto weight = hn::IfThenElseZero(
          is_seen,
          hn::Add(hn::LoadU(d, row.confidence + i), hn::Set(d, blending::least_confidence)));
      const auto is_first = hn::Gt(weight, first);
      const auto is_second = hn::Or(is_first, hn::Gt(weight, second));
      const auto moves_first = hn::RebindMask(di, is_first);
      const auto moves_second = hn::RebindMask(di, is_second);
      const auto source = hn::Set(di, row.source);
      third = hn::IfThenElse(is_second, second, hn::Max(third, weight));
      second = hn::IfThenElse(is_second, hn::IfThenElse(is_first, first, weight), second);
      second_z = hn::IfThenElse(is_second, hn::IfThenElse(is_first, first_z, z), second_z);
      second_source = hn::IfThenElse(
          moves_second, hn::IfThenElse(moves_first, first_source, source), second_source);
      first = hn::IfThenElse(is_first, weight, first);
      first_z = hn::IfThenElse(is_first, z, first_z);
      first_source = hn::IfThenElse(moves_first, source, first_source);
    }
    const auto beyond_third = hn::Sub(second, third);
    const auto sum = hn::Add(hn::Sub(first, third), beyond_third);
    const auto mixed = hn::Gt(beyond_third, zero);
    const auto part = hn::IfThenElseZero(
        mixed, hn::Div(hn::Mul(hn::Set(d, 255.F), beyond_third), hn::Max(sum, hn::Set(d, 1e-9F))));
    const auto share = hn::NearestInt(part);
    const auto has_second = hn::Gt(share, hn::Zero(di));
    hn::StoreU(first_z, d, out.depth_m + i);
    StoreBytes(d, first_source, out.source + i);
    hn::StoreU(second_z, d, out.second_depth_m + i);
    StoreBytes(d, hn::IfThenElseZero(has_second, second_source), out.second_source + i);
    StoreBytes(d, share, out.share + i);
  });
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(FindSeen);
HWY_EXPORT(ChooseTwo);

void find_seen(const std::vector<BlendedRow>& rows, float agreement_m, int width,
               std::uint8_t* seen, std::uint8_t* lone) {
  HWY_DYNAMIC_DISPATCH(FindSeen)(rows, agreement_m, width, seen, lone);
}

void choose_two(const std::vector<BlendedRow>& rows, int width, const std::uint8_t* seen,
                const TwoSources& out) {
  HWY_DYNAMIC_DISPATCH(ChooseTwo)(rows, width, seen, out);
}

}  // namespace diminish
#endif
