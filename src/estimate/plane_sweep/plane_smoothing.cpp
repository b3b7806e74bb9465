#include "estimate/plane_sweep/plane_smoothing.h"

#include <algorithm>
#include <vector>

#include "core/rows.h"

namespace diminish {
namespace {

/// Adds a pair of neighbours to the sums of a pixel.
inline void add_pair(float center, float before, float after, float per_tolerance, float& sum,
                     float& weight) {
  const float a = before - center;
  const float b = after - center;
  const float farther = std::max(a * a, b * b) * per_tolerance;
  const float w = std::max(0.F, 1 - farther);
  sum += w * (a + b);
  weight += 2 * w;
}

/// Of pixels [0, count): from those two steps of `pitch` pixels before to two after.
void smooth_row(const float* __restrict centers, const float* __restrict a2,
                const float* __restrict a1, const float* __restrict b1, const float* __restrict b2,
                int count, float per_tolerance, float* __restrict out) {
  for (int x = 0; x < count; ++x) {
    float sum = 0;
    float weight = 1;
    add_pair(centers[x], a1[x], b1[x], per_tolerance, sum, weight);
    add_pair(centers[x], a2[x], b2[x], per_tolerance, sum, weight);
    out[x] = centers[x] > 0 ? centers[x] + sum / weight : centers[x];
  }
}

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
        if (inner <= 0) continue;
        const float* const first = row + 2 * step;
        smooth_row(first, first - 2 * step, first - step, first + step, first + 2 * step, inner,
                   per_tolerance, out + 2 * step);
      }
    });
    for_rows(height, [&](Rows rows) {
      for (int y = rows.first; y < rows.last; ++y) {
        float* const out = inverse_depth.row(y);
        if (y < 2 * step || y + 2 * step >= height) {
          std::copy_n(between_.row(y), width, out);
          continue;
        }
        smooth_row(between_.row(y), between_.row(y - 2 * step), between_.row(y - step),
                   between_.row(y + step), between_.row(y + 2 * step), width, per_tolerance, out);
      }
    });
  }
}

}  // namespace diminish
