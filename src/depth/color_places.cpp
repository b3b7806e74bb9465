#include "depth/color_places.h"

#include <cmath>

#include "depth/discontinuity.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "depth/color_places.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "geometry/projection_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using Vector = hn::Vec<Floats>;

HWY_INLINE Vector Set(float value) {
  return hn::Set(Floats(), value);
}

/// As ColorPlaces::at.
template <LensModel model>
void FindPlacesBy(const ColorPlaces::Constants& constants, const float* ray_x, const float* ray_y,
                  const float* depth_m, int count, std::int32_t* columns, std::int32_t* lines) {
  const Floats d;
  const Ints di;
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d))) {
    const Vector z = hn::LoadU(d, depth_m + i);
    const Vector side = hn::Mul(hn::LoadU(d, ray_x + i), z);
    const Vector down = hn::Mul(hn::LoadU(d, ray_y + i), z);
    const Vector ahead = Apply(d, constants.to_color, 2, side, down, z);
    const Vector x = hn::Div(Apply(d, constants.to_color, 0, side, down, z), ahead);
    const Vector y = hn::Div(Apply(d, constants.to_color, 1, side, down, z), ahead);
    Vector u, v;
    const auto in_radius = Distort<model>(d, constants.color, x, y, u, v);
    const Vector one = Set(1);
    const auto is_seen = hn::And(hn::Gt(ahead, Set(sdct::near_plane_m)), in_radius);
    const auto is_right = hn::And(hn::Ge(u, one), hn::Lt(u, Set(constants.end_column)));
    const auto is_below = hn::And(hn::Ge(v, one), hn::Lt(v, Set(constants.end_line)));
    const auto exists = hn::And(is_seen, hn::And(is_right, is_below));
    const auto place = [&](Vector at) HWY_ATTR {
      const auto whole = hn::NearestInt(hn::IfThenElseZero(exists, at));
      return hn::IfThenElse(hn::RebindMask(di, exists), whole, hn::Set(di, -1));
    };
    hn::StoreU(place(u), di, columns + i);
    hn::StoreU(place(v), di, lines + i);
  }
}

void FindPlaces(const ColorPlaces::Constants& constants, const float* ray_x, const float* ray_y,
                const float* depth_m, int count, std::int32_t* columns, std::int32_t* lines) {
  with_lens_model(constants.color.model, [&](auto model) {
    FindPlacesBy<decltype(model)::value>(constants, ray_x, ray_y, depth_m, count, columns, lines);
  });
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(FindPlaces);

ColorPlaces::ColorPlaces(const RgbdCamera& camera)
    : constants_{FloatTransform(camera.color_from_depth), Projection(Lens(camera.color)),
                 static_cast<float>(camera.color.width - 2),
                 static_cast<float>(camera.color.height - 2)} {}

ColorPlaces::Place ColorPlaces::at(float ray_x, float ray_y, float depth_m) const {
  constexpr Place none{-1, -1};
  const FloatTransform& to_color = constants_.to_color;
  const float side = ray_x * depth_m;
  const float down = ray_y * depth_m;
  const float ahead = to_color.apply(2, side, down, depth_m);
  float u = 0;
  float v = 0;
  if (!(ahead > sdct::near_plane_m) ||
      !constants_.color.distort(to_color.apply(0, side, down, depth_m) / ahead,
                                to_color.apply(1, side, down, depth_m) / ahead, u, v) ||
      !(u >= 1 && v >= 1 && u < constants_.end_column && v < constants_.end_line)) {
    return none;
  }
  return {static_cast<int>(std::lrint(u)), static_cast<int>(std::lrint(v))};
}

void ColorPlaces::find(const float* ray_x, const float* ray_y, const float* depth_m, int count,
                       std::int32_t* columns, std::int32_t* lines) const {
  HWY_DYNAMIC_DISPATCH(FindPlaces)(constants_, ray_x, ray_y, depth_m, count, columns, lines);
}

}  // namespace diminish
#endif
