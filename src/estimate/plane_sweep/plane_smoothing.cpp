#include "estimate/plane_sweep/plane_smoothing.h"

#include <algorithm>

#include "core/rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimate/plane_sweep/plane_smoothing.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "estimate/plane_sweep/row_motion-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Pixels [0, count) of a row, from those at one and two times `pitch` on both sides.
void SmoothRow(const float* centers, std::ptrdiff_t pitch, int count, float per_tolerance,
               float* out) {
  ForEachPixelVector(count, [&](auto d, int x) HWY_ATTR {
    const auto center = hn::LoadU(d, centers + x);
    const auto one = hn::Set(d, 1.F);
    auto sum = hn::Zero(d);
    auto weight = one;
    for (std::ptrdiff_t away = pitch; away <= 2 * pitch; away += pitch) {
      const auto before = hn::Sub(hn::LoadU(d, centers + x - away), center);
      const auto after = hn::Sub(hn::LoadU(d, centers + x + away), center);
      const auto farther = hn::Max(hn::Mul(before, before), hn::Mul(after, after));
      const auto counts =
          hn::Max(hn::Zero(d), hn::Sub(one, hn::Mul(farther, hn::Set(d, per_tolerance))));
      sum = hn::Add(sum, hn::Mul(counts, hn::Add(before, after)));
      weight = hn::Add(weight, hn::Add(counts, counts));
    }
    const auto mean = hn::Add(center, hn::Div(sum, weight));
    hn::StoreU(hn::IfThenElse(hn::Gt(center, hn::Zero(d)), mean, center), d, out + x);
  });
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(SmoothRow);

}  // namespace

void PlaneSmoothing::smooth(float tolerance, int widest_px, Image<float>& inverse_depth) {
  const int width = inverse_depth.width();
  const int height = inverse_depth.height();
  between_.resize(width, height);
  const float per_tolerance = 1 / (tolerance * tolerance);
  for (int step = 1; step <= widest_px; step *= 2) {
    for_rows(height, [&](Rows rows) {
      for (int y = rows.first; y < rows.last; ++y) {
        const float* const row = inverse_depth.row(y);
        float* const out = between_.row(y);
        std::copy_n(row, width, out);
        const int inner = width - 4 * step;
        const std::ptrdiff_t first = std::ptrdiff_t{2} * step;
        if (inner <= 0) continue;
        HWY_DYNAMIC_DISPATCH(SmoothRow)
        (row + first, step, inner, per_tolerance, out + first);
      }
    });
    for_rows(height, [&](Rows rows) {
      for (int y = rows.first; y < rows.last; ++y) {
        float* const out = inverse_depth.row(y);
        if (y < 2 * step || y + 2 * step >= height) {
          std::copy_n(between_.row(y), width, out);
          continue;
        }
        HWY_DYNAMIC_DISPATCH(SmoothRow)
        (between_.row(y), std::ptrdiff_t{step} * width, width, per_tolerance, out);
      }
    });
  }
}

}  // namespace diminish
#endif
