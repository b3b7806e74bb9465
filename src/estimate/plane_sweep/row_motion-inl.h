// Included once for each instruction set: where another view shows a row's pixels.
#if defined(DIMINISH_ROW_MOTION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DIMINISH_ROW_MOTION_INL_H
#undef DIMINISH_ROW_MOTION_INL_H
#else
#define DIMINISH_ROW_MOTION_INL_H
#endif

#include <hwy/highway.h>

#include "estimate/plane_sweep/sweep_geometry.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

/// Visits a row one vector at a time, and the rest pixel by pixel.
template <class Visit>
HWY_INLINE void ForEachPixelVector(int count, const Visit& visit) {
  const hwy::HWY_NAMESPACE::CappedTag<float, 16> d;
  const auto lanes = static_cast<int>(hwy::HWY_NAMESPACE::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) visit(d, x);
  for (; x < count; ++x) visit(hwy::HWY_NAMESPACE::CappedTag<float, 1>(), x);
}

/// Where the other view shows pixels x, x + 1, .. of row y that have these inverse depths.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE void Move(D d, const Parallax& parallax, int x, int y, V inverse_depth, V& u, V& v) {
  namespace hn = hwy::HWY_NAMESPACE;
  const auto one = hn::Set(d, 1.F);
  const auto s = hn::Div(one, hn::Add(one, hn::Mul(hn::Set(d, parallax.z), inverse_depth)));
  const auto rest = hn::Sub(one, s);
  const auto along = [&](V pixel, float shift, float center, float offset) HWY_ATTR {
    const auto moved = hn::Mul(hn::Add(pixel, hn::Mul(hn::Set(d, shift), inverse_depth)), s);
    return hn::Add(hn::Add(moved, hn::Mul(rest, hn::Set(d, center))), hn::Set(d, offset));
  };
  u = along(hn::Iota(d, static_cast<float>(x)), parallax.x, parallax.cx, parallax.offset_x);
  v = along(hn::Set(d, static_cast<float>(y)), parallax.y, parallax.cy, parallax.offset_y);
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
