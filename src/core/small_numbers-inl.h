// Included once for each instruction set. Highway's conversions of floats to whole numbers are
// defined for all floats, which takes x86 four instructions more. These are for floats whose whole
// number fits 32 bits. (Vectors of 512 bits take Highway's way.)
#if defined(DIMINISH_SMALL_NUMBERS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DIMINISH_SMALL_NUMBERS_INL_H
#undef DIMINISH_SMALL_NUMBERS_INL_H
#else
#define DIMINISH_SMALL_NUMBERS_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

template <class V>
using WholeNumbers =
    hwy::HWY_NAMESPACE::Vec<hwy::HWY_NAMESPACE::RebindToSigned<hwy::HWY_NAMESPACE::DFromV<V>>>;

/// hn::NearestInt.
template <class V>
HWY_INLINE WholeNumbers<V> NearestSmall(V values) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  if constexpr (sizeof(values.raw) == 16) {
    return WholeNumbers<V>{_mm_cvtps_epi32(values.raw)};
#if HWY_TARGET <= HWY_AVX2
  } else if constexpr (sizeof(values.raw) == 32) {
    return WholeNumbers<V>{_mm256_cvtps_epi32(values.raw)};
#endif
  }
#endif
  return hwy::HWY_NAMESPACE::NearestInt(values);
}

/// hn::ConvertTo, towards 0.
template <class V>
HWY_INLINE WholeNumbers<V> TruncateSmall(V values) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  if constexpr (sizeof(values.raw) == 16) {
    return WholeNumbers<V>{_mm_cvttps_epi32(values.raw)};
#if HWY_TARGET <= HWY_AVX2
  } else if constexpr (sizeof(values.raw) == 32) {
    return WholeNumbers<V>{_mm256_cvttps_epi32(values.raw)};
#endif
  }
#endif
  return hwy::HWY_NAMESPACE::ConvertTo(
      hwy::HWY_NAMESPACE::RebindToSigned<hwy::HWY_NAMESPACE::DFromV<V>>(), values);
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
