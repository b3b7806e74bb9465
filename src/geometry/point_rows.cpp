#include "geometry/point_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/point_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "geometry/projection_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

template <LensModel model, class D>
HWY_INLINE void FindSome(D d, const PointRow& points, const PointView& view, int i,
                         std::int32_t* pixels, float* depth_m) {
  const hn::RebindToSigned<D> di;
  const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
  const auto own_z = hn::LoadU(d, points.depth_m + i);
  const auto own_x = hn::Mul(hn::LoadU(d, points.ray_x + i), own_z);
  const auto own_y = hn::Mul(hn::LoadU(d, points.ray_y + i), own_z);
  const auto apply = [&](int axis)
                         HWY_ATTR { return Apply(d, view.from_points, axis, own_x, own_y, own_z); };
  const auto z = apply(2);
  hn::Vec<D> u, v;
  const auto in_radius =
      Distort<model>(d, view.lens, hn::Div(apply(0), z), hn::Div(apply(1), z), u, v);
  const auto limit = set(farthest_px);
  const auto valid =
      hn::And(hn::And(hn::Gt(own_z, hn::Zero(d)), hn::Gt(z, set(nearest_seen_m))),
              hn::And(in_radius, hn::And(hn::Lt(hn::Abs(u), limit), hn::Lt(hn::Abs(v), limit))));
  // Invalid values become 0, which can be converted safely.
  const auto column = hn::NearestInt(hn::IfThenElseZero(valid, u));
  const auto row = hn::NearestInt(hn::IfThenElseZero(valid, v));
  const auto before = [&](int value) HWY_ATTR { return hn::Set(di, value - 1); };
  const auto inside = hn::And(
      hn::And(hn::Gt(column, before(view.inside.x)),
              hn::Lt(column, hn::Set(di, view.inside.right()))),
      hn::And(hn::Gt(row, before(view.inside.y)), hn::Lt(row, hn::Set(di, view.inside.bottom()))));
  const auto index = hn::Add(hn::Mul(row, hn::Set(di, view.pitch)), column);
  hn::StoreU(hn::IfThenElse(hn::And(inside, hn::RebindMask(di, valid)), index, hn::Set(di, -1)), di,
             pixels + i);
  hn::StoreU(z, d, depth_m + i);
}

template <LensModel model>
void FindPixelsBy(const PointRow& points, const PointView& view, std::int32_t* pixels,
                  float* depth_m) {
  const hn::ScalableTag<float> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int i = 0;
  for (; i + lanes <= points.count; i += lanes) {
    FindSome<model>(d, points, view, i, pixels, depth_m);
  }
  for (; i < points.count; ++i) {
    FindSome<model>(hn::CappedTag<float, 1>(), points, view, i, pixels, depth_m);
  }
}

void FindPixels(const PointRow& points, const PointView& view, std::int32_t* pixels,
                float* depth_m) {
  with_lens_model(view.lens.model, [&](auto model) {
    FindPixelsBy<decltype(model)::value>(points, view, pixels, depth_m);
  });
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(FindPixels);

void find_pixels(const PointRow& points, const PointView& view, std::int32_t* pixels,
                 float* depth_m) {
  HWY_DYNAMIC_DISPATCH(FindPixels)(points, view, pixels, depth_m);
}

}  // namespace diminish
#endif
