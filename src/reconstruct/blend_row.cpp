#include "reconstruct/blend_row.h"

#include "reconstruct/depth_noise.h"
#include "reconstruct/layers.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reconstruct/blend_row.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;

/// Stands for the depth of nothing.
constexpr float beyond_m = 1e9F;

/// Calls `visit(tag, first)` for vectors of pixels that cover a row; the last may overlap the one
/// before it. Rows shorter than a vector are walked pixel by pixel.
template <class Visit>
HWY_INLINE void ForEachVector(int width, const Visit& visit) {
  const auto lanes = static_cast<int>(hn::Lanes(Floats()));
  if (width < lanes) {
    for (int i = 0; i < width; ++i) visit(hn::CappedTag<float, 1>(), i);
    return;
  }
  for (int i = 0; i + lanes <= width; i += lanes) visit(Floats(), i);
  if (width % lanes != 0) visit(Floats(), width - lanes);
}

/// One camera's surface in a vector of pixels.
template <class D>
struct Surface {
  hn::Mask<D> there;
  hn::Vec<D> z, noise;

  HWY_INLINE Surface(D d, const BlendedRow& row, int i) {
    const auto inverse_z = hn::LoadU(d, row.inverse_z + i);
    there = hn::Gt(inverse_z, hn::Zero(d));
    z = hn::IfThenElse(there, hn::Div(hn::Set(d, 1.F), inverse_z), hn::Set(d, beyond_m));
    const auto slope = hn::MulAdd(hn::Iota(d, static_cast<float>(i)), hn::Set(d, row.depth_step),
                                  hn::Set(d, row.depth_slope));
    const auto depth = hn::Sub(hn::Mul(z, slope), hn::Set(d, row.depth_offset_m));
    constexpr DepthNoise model;
    noise = hn::MulAdd(hn::Mul(hn::Set(d, model.by_square), depth), depth,
                       hn::Set(d, model.constant_m));
  }
};

/// agreement_tolerance_m (camera_place.h).
template <class D>
HWY_INLINE hn::Vec<D> Tolerance(D d, float agreement_m, hn::Vec<D> noise_a, hn::Vec<D> noise_b) {
  return hn::Max(hn::Set(d, agreement_m), hn::Add(noise_a, noise_b));
}

/// The nearest surface.
template <class D>
struct Front {
  hn::Vec<D> z, noise;

  HWY_INLINE Front(D d, const std::vector<BlendedRow>& rows, int i)
      : z(hn::Set(d, beyond_m)), noise(hn::Zero(d)) {
    for (const BlendedRow& row : rows) {
      const Surface<D> surface(d, row, i);
      const auto nearer = hn::Lt(surface.z, z);
      z = hn::IfThenElse(nearer, surface.z, z);
      noise = hn::IfThenElse(nearer, surface.noise, noise);
    }
  }
  HWY_INLINE hn::Mask<D> IsSeenBy(D d, const Surface<D>& surface, float agreement_m) const {
    return hn::And(surface.there,
                   hn::Le(hn::Sub(surface.z, z), Tolerance(d, agreement_m, surface.noise, noise)));
  }
};

template <class D>
HWY_INLINE void StoreBytes(D, hn::Vec<hn::RebindToSigned<D>> values, std::uint8_t* to) {
  const hn::Rebind<std::uint8_t, D> d8;
  hn::StoreU(hn::DemoteTo(d8, values), d8, to);
}

void FindLone(const std::vector<BlendedRow>& rows, float agreement_m, int width,
              std::uint8_t* lone) {
  ForEachVector(width, [&](auto d, int i) HWY_ATTR {
    using D = decltype(d);
    const hn::RebindToSigned<D> di;
    auto nearest = hn::Set(d, beyond_m);
    auto next = nearest;
    auto nearest_noise = hn::Zero(d);
    auto next_noise = nearest_noise;
    for (const BlendedRow& row : rows) {
      const Surface<D> surface(d, row, i);
      const auto nearer = hn::Lt(surface.z, nearest);
      const auto is_next = hn::Or(nearer, hn::Lt(surface.z, next));
      next = hn::IfThenElse(is_next, hn::IfThenElse(nearer, nearest, surface.z), next);
      next_noise =
          hn::IfThenElse(is_next, hn::IfThenElse(nearer, nearest_noise, surface.noise), next_noise);
      nearest = hn::IfThenElse(nearer, surface.z, nearest);
      nearest_noise = hn::IfThenElse(nearer, surface.noise, nearest_noise);
    }
    const auto tolerance = Tolerance(d, agreement_m, nearest_noise, next_noise);
    const auto apart =
        hn::And(hn::Lt(next, hn::Set(d, beyond_m)), hn::Gt(hn::Sub(next, nearest), tolerance));
    StoreBytes(d, hn::IfThenElseZero(hn::RebindMask(di, apart), hn::Set(di, 255)), lone + i);
  });
}

void MarkUncovered(const std::vector<BlendedRow>& rows, float agreement_m, int width,
                   const std::vector<std::uint8_t*>& covered) {
  ForEachVector(width, [&](auto d, int i) HWY_ATTR {
    using D = decltype(d);
    const hn::RebindToSigned<D> di;
    const hn::Rebind<std::uint8_t, D> d8;
    const Front<D> front(d, rows, i);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const auto seen = front.IsSeenBy(d, Surface<D>(d, rows[k], i), agreement_m);
      if (hn::AllTrue(d, seen)) continue;
      const auto old = hn::PromoteTo(di, hn::LoadU(d8, covered[k] + i));
      StoreBytes(d, hn::IfThenElseZero(hn::RebindMask(di, seen), old), covered[k] + i);
    }
  });
}

void ChooseTwo(const std::vector<BlendedRow>& rows, float agreement_m, int width,
               const TwoSources& out) {
  ForEachVector(width, [&](auto d, int i) HWY_ATTR {
    using D = decltype(d);
    const hn::RebindToSigned<D> di;
    const Front<D> front(d, rows, i);
    const auto zero = hn::Zero(d);
    auto first = zero, second = zero, third = zero;
    auto first_z = zero, second_z = zero;
    auto first_source = hn::Zero(di), second_source = hn::Zero(di);
    for (const BlendedRow& row : rows) {
      const Surface<D> surface(d, row, i);
      const auto seen = front.IsSeenBy(d, surface, agreement_m);
      if (hn::AllFalse(d, seen)) continue;
      const auto weight = hn::IfThenElseZero(
          seen, hn::Add(hn::LoadU(d, row.confidence + i), hn::Set(d, blending::least_confidence)));
      const auto is_first = hn::Gt(weight, first);
      const auto is_second = hn::Or(is_first, hn::Gt(weight, second));
      const auto moves_first = hn::RebindMask(di, is_first);
      const auto moves_second = hn::RebindMask(di, is_second);
      const auto source = hn::Set(di, row.source);
      third = hn::IfThenElse(is_second, second, hn::Max(third, weight));
      second = hn::IfThenElse(is_second, hn::IfThenElse(is_first, first, weight), second);
      second_z = hn::IfThenElse(is_second, hn::IfThenElse(is_first, first_z, surface.z), second_z);
      second_source = hn::IfThenElse(
          moves_second, hn::IfThenElse(moves_first, first_source, source), second_source);
      first = hn::IfThenElse(is_first, weight, first);
      first_z = hn::IfThenElse(is_first, surface.z, first_z);
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

HWY_EXPORT(FindLone);
HWY_EXPORT(MarkUncovered);
HWY_EXPORT(ChooseTwo);

void find_lone(const std::vector<BlendedRow>& rows, float agreement_m, int width,
               std::uint8_t* lone) {
  HWY_DYNAMIC_DISPATCH(FindLone)(rows, agreement_m, width, lone);
}

void mark_uncovered(const std::vector<BlendedRow>& rows, float agreement_m, int width,
                    const std::vector<std::uint8_t*>& covered) {
  HWY_DYNAMIC_DISPATCH(MarkUncovered)(rows, agreement_m, width, covered);
}

void choose_two(const std::vector<BlendedRow>& rows, float agreement_m, int width,
                const TwoSources& out) {
  HWY_DYNAMIC_DISPATCH(ChooseTwo)(rows, agreement_m, width, out);
}

}  // namespace diminish
#endif
