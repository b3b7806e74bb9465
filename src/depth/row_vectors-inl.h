// Included once for each instruction set: helpers for kernels on rows of depths.
#if defined(DIMINISH_ROW_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DIMINISH_ROW_VECTORS_INL_H
#undef DIMINISH_ROW_VECTORS_INL_H
#else
#define DIMINISH_ROW_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include "depth/depth_noise.h"
#include "depth/discontinuity.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

constexpr int most_lanes = 16;

/// Visits a row one vector at a time, and the rest pixel by pixel.
template <class Visit>
HWY_INLINE void ForEachVector(int count, const Visit& visit) {
  const hwy::HWY_NAMESPACE::CappedTag<float, most_lanes> d;
  const auto lanes = static_cast<int>(hwy::HWY_NAMESPACE::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) visit(d, x);
  for (; x < count; ++x) visit(hwy::HWY_NAMESPACE::CappedTag<float, 1>(), x);
}

/// Visits vectors of pixels that cover a row. The last may overlap the one before it, so a visit
/// must not depend on earlier ones. Rows shorter than a vector are visited pixel by pixel.
template <class Visit>
HWY_INLINE void ForEachOverlappingVector(int count, const Visit& visit) {
  const hwy::HWY_NAMESPACE::CappedTag<float, most_lanes> d;
  const auto lanes = static_cast<int>(hwy::HWY_NAMESPACE::Lanes(d));
  if (count < lanes) {
    for (int x = 0; x < count; ++x) visit(hwy::HWY_NAMESPACE::CappedTag<float, 1>(), x);
    return;
  }
  for (int x = 0; x + lanes <= count; x += lanes) visit(d, x);
  if (count % lanes != 0) visit(d, count - lanes);
}

/// One byte a lane, of integers (cut to 0 to 255). D: a tag of as many floats.
template <class D>
HWY_INLINE void StoreBytes(D /*d*/,
                           hwy::HWY_NAMESPACE::Vec<hwy::HWY_NAMESPACE::RebindToSigned<D>> values,
                           std::uint8_t* to) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::Rebind<std::uint8_t, D> bytes;
  hn::StoreU(hn::DemoteTo(bytes, values), bytes, to);
}

/// Of a depth in metres.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE V NoiseAt(D d, const DepthNoise& noise, V z) {
  namespace hn = hwy::HWY_NAMESPACE;
  return hn::Add(hn::Set(d, noise.constant_m), hn::Mul(hn::Mul(hn::Set(d, noise.by_square), z), z));
}

/// sdct::Threshold::at.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE V ThresholdAt(D d, const sdct::Threshold& threshold, V z) {
  namespace hn = hwy::HWY_NAMESPACE;
  const V relative = hn::Mul(z, hn::Set(d, threshold.inverse_reach));
  return hn::Mul(hn::Max(hn::Set(d, 1.F), hn::Mul(relative, relative)),
                 hn::Set(d, threshold.constant_m));
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
