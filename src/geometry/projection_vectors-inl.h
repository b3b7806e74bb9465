// Included once for each instruction set: FloatTransform and Projection of vectors. Products and
// sums stay separate (no fused multiply-add) and in the plain version's order, so that every CPU
// computes the same bits as plain C++.
#if defined(DIMINISH_PROJECTION_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DIMINISH_PROJECTION_VECTORS_INL_H
#undef DIMINISH_PROJECTION_VECTORS_INL_H
#else
#define DIMINISH_PROJECTION_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include "geometry/distortion_vectors-inl.h"
#include "geometry/projection.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

/// FloatTransform::apply.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE V Apply(D d, const FloatTransform& t, int axis, V x, V y, V z) {
  namespace hn = hwy::HWY_NAMESPACE;
  const auto& r = t.r[axis];
  const V turned = hn::Add(hn::Add(hn::Mul(hn::Set(d, r[0]), x), hn::Mul(hn::Set(d, r[1]), y)),
                           hn::Mul(hn::Set(d, r[2]), z));
  return hn::Add(turned, hn::Set(d, t.t[axis]));
}

/// Projection::distort; the mask of lanes inside the valid radius.
template <LensModel model, class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE hwy::HWY_NAMESPACE::Mask<D> Distort(D d, const Projection& p, V x, V y, V& u, V& v) {
  namespace hn = hwy::HWY_NAMESPACE;
  const V r2 = hn::Add(hn::Mul(x, x), hn::Mul(y, y));
  V distorted_x, distorted_y;
  distort_ray<model>(
      p.distortion, [&](float value) HWY_ATTR { return hn::Set(d, value); }, x, y, r2, distorted_x,
      distorted_y);
  u = hn::Add(hn::Mul(hn::Set(d, p.fx), distorted_x), hn::Set(d, p.cx));
  v = hn::Add(hn::Mul(hn::Set(d, p.fy), distorted_y), hn::Set(d, p.cy));
  return hn::Lt(r2, hn::Set(d, p.max_radius_squared));
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
