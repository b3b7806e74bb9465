// Included once for each instruction set: distortion of vectors.
#if defined(DIMINISH_DISTORTION_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DIMINISH_DISTORTION_VECTORS_INL_H
#undef DIMINISH_DISTORTION_VECTORS_INL_H
#else
#define DIMINISH_DISTORTION_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include "geometry/distortion.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

template <class Number>
HWY_INLINE Number square_root(const Number& value) {
  return hwy::HWY_NAMESPACE::Sqrt(value);
}

#define DIMINISH_FORMULA HWY_INLINE
#include "geometry/distortion_formulas.h"
#undef DIMINISH_FORMULA

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
