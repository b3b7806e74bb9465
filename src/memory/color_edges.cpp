#include "memory/color_edges.h"

#include <algorithm>
#include <cmath>

#include "core/rows.h"

namespace diminish {
namespace {

/// How far from a depth edge the true one may be, and how far away colours are compared.
constexpr int band_reach = 4;
constexpr int reach = 10;

bool is_step(float a, float b) {
  constexpr float smallest = 0.05F;
  return a > 0 && b > 0 && std::abs(a - b) > smallest * std::max(a, b);
}

Rect around(int x, int y, int distance, const Rect& bounds) {
  return intersect(grow({x, y, 1, 1}, distance), bounds);
}

float likeness(const Bgr& a, const Bgr& b) {
  constexpr float scale = 300;
  const float weight = 1 / (1 + static_cast<float>(squared_difference(a, b)) / scale);
  return weight * weight;
}

}  // namespace

void ColorEdges::find_band(const Image<float>& inverse_depth) {
  const Rect bounds = inverse_depth.bounds();
  band_.resize(bounds.width, bounds.height, 0);
  for (int y = 0; y + 1 < bounds.height; ++y) {
    for (int x = 0; x + 1 < bounds.width; ++x) {
      const float own = inverse_depth(x, y);
      if (is_step(own, inverse_depth(x + 1, y)) || is_step(own, inverse_depth(x, y + 1))) {
        band_.fill(around(x, y, band_reach, bounds), 1);
      }
    }
  }
}

void ColorEdges::align(const Image<Bgr>& colors, Image<float>& inverse_depth) {
  const Rect bounds = inverse_depth.bounds();
  before_ = inverse_depth;
  find_band(before_);
  for_rows(bounds.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < bounds.width; ++x) {
        if (band_(x, y) == 0) continue;
        float far = before_(x, y);
        float near = far;
        const Rect inner = around(x, y, band_reach, bounds);
        for (int row = inner.y; row < inner.bottom(); ++row) {
          for (int column = inner.x; column < inner.right(); ++column) {
            const float value = before_(column, row);
            if (!(value > 0)) continue;
            far = far > 0 ? std::min(far, value) : value;
            near = std::max(near, value);
          }
        }
        if (!is_step(far, near)) continue;
        const float middle = (near + far) / 2;
        float votes[2] = {};
        float sums[2] = {};
        const Rect outer = around(x, y, reach, bounds);
        for (int row = outer.y; row < outer.bottom(); row += 2) {
          for (int column = outer.x; column < outer.right(); column += 2) {
            const float value = before_(column, row);
            if (band_(column, row) != 0 || value > 1.1F * near || value < 0.9F * far) continue;
            const float weight = likeness(colors(column, row), colors(x, y));
            const int side = value > middle ? 1 : 0;
            votes[side] += weight;
            sums[side] += weight * value;
          }
        }
        const int own = before_(x, y) > middle ? 1 : 0;
        const int other = 1 - own;
        if (votes[other] > 1 && votes[other] > 2 * votes[own]) {
          inverse_depth(x, y) = sums[other] / votes[other];
        }
      }
    }
  });
}

}  // namespace diminish
