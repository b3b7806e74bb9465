#include "scene/surface_rows.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/surface_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/small_numbers-inl.h"
#include "depth/row_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::surface_rows::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using diminish::HWY_NAMESPACE::ForEachOverlappingVector;
using diminish::HWY_NAMESPACE::ForEachVector;
using diminish::HWY_NAMESPACE::NoiseAt;
using diminish::HWY_NAMESPACE::StoreBytes;
using diminish::HWY_NAMESPACE::TruncateSmall;

template <class D>
HWY_INLINE hn::Vec<D> Linear(D d, float start, float slope, hn::Vec<D> at) {
  return hn::Add(hn::Set(d, start), hn::Mul(at, hn::Set(d, slope)));
}

template <int plane_count>
void LabelByPlanes(const float* depth_m, const Segment* segments, std::size_t segment_count,
                   const DepthNoise& tolerance, std::uint8_t* surface) {
  const DepthNoise twice{2 * tolerance.constant_m, 2 * tolerance.by_square};
  for (std::size_t i = 0; i < segment_count; ++i) {
    const int count = segments[i].count;
    InverseDepth planes[std::max(1, plane_count)];
    std::copy_n(segments[i].planes.data(), plane_count, planes);
    ForEachOverlappingVector(count, [=](auto d, int x) HWY_ATTR {
      const hn::RebindToSigned<decltype(d)> labels;
      const auto z = hn::LoadU(d, depth_m + x);
      const auto at = hn::Iota(d, static_cast<float>(x));
      const auto most = NoiseAt(d, twice, z);
      auto greatest = hn::Zero(d);
      auto nearest = hn::Set(labels, surface_label::unknown);
      auto own = hn::Set(labels, surface_label::foreground);
      for (int k = 0; k < plane_count; ++k) {
        const auto label = hn::Set(labels, surface_label::first_plane + k);
        const auto inverse = Linear(d, planes[k].start, planes[k].slope, at);
        nearest = hn::IfThenElse(hn::RebindMask(labels, hn::Gt(inverse, greatest)), label, nearest);
        greatest = hn::Max(greatest, inverse);
        // (1/z - inverse) z is the difference in depth, relative to the plane's.
        const auto relative = hn::Abs(hn::Sub(hn::Set(d, 1.F), hn::Mul(inverse, z)));
        own =
            hn::IfThenElse(hn::RebindMask(labels, hn::Le(hn::Mul(relative, z), most)), label, own);
      }
      const auto is_measured = hn::RebindMask(labels, hn::Gt(z, hn::Zero(d)));
      StoreBytes(d, hn::IfThenElse(is_measured, own, nearest), surface + x);
    });
    depth_m += count;
    surface += count;
  }
}

/// Unrolled for the largest number of planes.
void Label(const float* depth_m, const Segment* segments, std::size_t segment_count,
           int plane_count, const DepthNoise& tolerance, std::uint8_t* surface) {
  using ByPlanes = decltype(&LabelByPlanes<0>);
  constexpr ByPlanes by_planes[] = {LabelByPlanes<0>, LabelByPlanes<1>, LabelByPlanes<2>,
                                    LabelByPlanes<3>};
  static_assert(std::size(by_planes) == most_planes + 1);
  by_planes[plane_count](depth_m, segments, segment_count, tolerance, surface);
}

void Shade(const Shading* shadings, int shading_count, const float* depth_m,
           const std::uint8_t* surface, int count, Bgr* light) {
  ForEachVector(count, [=](auto d, int x) HWY_ATTR {
    const hn::RebindToSigned<decltype(d)> levels;
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const auto labels = hn::PromoteTo(levels, hn::LoadU(bytes, surface + x));
    const auto z = hn::LoadU(d, depth_m + x);
    const auto at = hn::Iota(d, static_cast<float>(x));
    const auto one = hn::Set(d, 1.F);
    const auto zero = hn::Zero(d);
    auto blue = hn::Set(levels, 255);
    auto green = blue;
    auto red = blue;
    for (int k = 0; k < shading_count; ++k) {
      const Shading& shading = shadings[k];
      const auto is_on = hn::Eq(labels, hn::Set(levels, shading.label));
      if (hn::AllFalse(levels, is_on)) continue;
      const auto along = Linear(d, shading.first[3], shading.slope[3], at);
      const auto height_m = hn::Abs(hn::Sub(hn::Mul(along, z), hn::Set(d, shading.distance_m)));
      const auto fading_m = hn::Mul(hn::Set(d, shading.fading_height), NoiseAt(d, DepthNoise(), z));
      auto left = hn::Sub(hn::Set(d, 2.F), hn::Div(height_m, fading_m));
      left = hn::Min(hn::Max(left, zero), one);
      left = hn::IfThenElse(hn::Gt(z, zero), left, one);
      const auto shade = [&](int c, auto& level) HWY_ATTR {
        const auto dark = hn::Mul(Linear(d, shading.first[c], shading.slope[c], at), left);
        const auto lit = hn::Sub(hn::Set(d, 255.5F), hn::Mul(hn::Set(d, 255.F), dark));
        level = hn::IfThenElse(is_on, TruncateSmall(lit), level);
      };
      shade(0, blue);
      shade(1, green);
      shade(2, red);
    }
    hn::StoreInterleaved3(hn::DemoteTo(bytes, blue), hn::DemoteTo(bytes, green),
                          hn::DemoteTo(bytes, red), bytes,
                          reinterpret_cast<std::uint8_t*>(light + x));
  });
}

}  // namespace
}  // namespace diminish::surface_rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish::surface_rows {
namespace {

HWY_EXPORT(Label);
HWY_EXPORT(Shade);

}  // namespace

void label(const float* depth_m, std::span<const Segment> segments, int plane_count,
           const DepthNoise& tolerance, std::uint8_t* surface) {
  HWY_DYNAMIC_DISPATCH(Label)
  (depth_m, segments.data(), segments.size(), plane_count, tolerance, surface);
}
void shade(std::span<const Shading> shadings, const float* depth_m, const std::uint8_t* surface,
           int count, Bgr* light) {
  HWY_DYNAMIC_DISPATCH(Shade)
  (shadings.data(), static_cast<int>(shadings.size()), depth_m, surface, count, light);
}

}  // namespace diminish::surface_rows
#endif
