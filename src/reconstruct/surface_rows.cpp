#include "reconstruct/surface_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reconstruct/surface_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "reconstruct/row_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::surface_rows::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using diminish::HWY_NAMESPACE::ForEachVector;
using diminish::HWY_NAMESPACE::most_lanes;
using diminish::HWY_NAMESPACE::NoiseAt;
using diminish::HWY_NAMESPACE::StoreBytes;

template <class D>
HWY_INLINE hn::Vec<D> Linear(D d, float start, float slope, hn::Vec<D> at) {
  return hn::Add(hn::Set(d, start), hn::Mul(at, hn::Set(d, slope)));
}

void Label(const float* depth_m, int count, const InverseDepth* planes, int plane_count,
           const DepthNoise& tolerance, std::uint8_t* surface) {
  ForEachVector(count, [&](auto d, int x) HWY_ATTR {
    const auto z = hn::LoadU(d, depth_m + x);
    const auto at = hn::Iota(d, static_cast<float>(x));
    const auto twice = hn::Mul(hn::Set(d, 2.F), NoiseAt(d, tolerance, z));
    auto greatest = hn::Zero(d);
    auto nearest = hn::Set(d, static_cast<float>(surface_label::unknown));
    auto own = hn::Set(d, static_cast<float>(surface_label::foreground));
    for (int k = 0; k < plane_count; ++k) {
      const auto label = hn::Set(d, static_cast<float>(surface_label::first_plane + k));
      const auto inverse = Linear(d, planes[k].start, planes[k].slope, at);
      nearest = hn::IfThenElse(hn::Gt(inverse, greatest), label, nearest);
      greatest = hn::Max(greatest, inverse);
      // (1/z - inverse) z is the difference in depth, relative to the plane's.
      const auto relative = hn::Abs(hn::Sub(hn::Set(d, 1.F), hn::Mul(inverse, z)));
      own = hn::IfThenElse(hn::Le(hn::Mul(relative, z), twice), label, own);
    }
    const auto label = hn::IfThenElse(hn::Gt(z, hn::Zero(d)), own, nearest);
    StoreBytes(d, hn::ConvertTo(hn::RebindToSigned<decltype(d)>(), label), surface + x);
  });
}

void Shade(const Shading& shading, const float* depth_m, const std::uint8_t* surface, int count,
           Bgr* light) {
  ForEachVector(count, [&](auto d, int x) HWY_ATTR {
    const auto z = hn::LoadU(d, depth_m + x);
    const auto at = hn::Iota(d, static_cast<float>(x));
    const auto one = hn::Set(d, 1.F);
    const auto zero = hn::Zero(d);
    const auto& normal = shading.plane.normal;
    auto along = hn::Mul(hn::Set(d, normal.x()), Linear(d, shading.ray.x(), shading.slope.x(), at));
    along = hn::Add(
        along, hn::Mul(hn::Set(d, normal.y()), Linear(d, shading.ray.y(), shading.slope.y(), at)));
    along = hn::Mul(hn::Add(along, hn::Set(d, normal.z())), z);
    const auto height_m = hn::Abs(hn::Sub(along, hn::Set(d, shading.plane.distance_m)));
    const auto fading_m = hn::Mul(hn::Set(d, shading.fading_height), NoiseAt(d, DepthNoise(), z));
    auto left = hn::Sub(hn::Set(d, 2.F), hn::Div(height_m, fading_m));
    left = hn::Min(hn::Max(left, zero), one);
    left = hn::IfThenElse(hn::Gt(z, zero), left, one);
    std::uint8_t levels[3][most_lanes];
    for (int c = 0; c < 3; ++c) {
      const auto dark = hn::Mul(Linear(d, shading.dark[c], shading.dark_slope[c], at), left);
      const auto full = hn::Set(d, 255.F);
      const auto level = hn::Sub(hn::Set(d, 255.5F), hn::Mul(full, dark));
      StoreBytes(d, hn::ConvertTo(hn::RebindToSigned<decltype(d)>(), level), levels[c]);
    }
    for (int i = 0; i < static_cast<int>(hn::Lanes(d)); ++i) {
      if (surface[x + i] == shading.label)
        light[x + i] = {levels[0][i], levels[1][i], levels[2][i]};
    }
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

void label(const float* depth_m, int count, const InverseDepth* planes, int plane_count,
           const DepthNoise& tolerance, std::uint8_t* surface) {
  HWY_DYNAMIC_DISPATCH(Label)(depth_m, count, planes, plane_count, tolerance, surface);
}
void shade(const Shading& shading, const float* depth_m, const std::uint8_t* surface, int count,
           Bgr* light) {
  HWY_DYNAMIC_DISPATCH(Shade)(shading, depth_m, surface, count, light);
}

}  // namespace diminish::surface_rows
#endif
