#include "depth/plane_windows.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "depth/plane_windows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/small_numbers-inl.h"
#include "depth/row_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::plane_windows::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using diminish::HWY_NAMESPACE::ForEachVector;
using diminish::HWY_NAMESPACE::TruncateSmall;

constexpr double pixels = side * side;
/// The sum of squared columns, or rows, of a window.
constexpr double squares = side * (2.0 * (1 + 4 + 9));
static_assert(reach == 3, "squares");

/// ForEachVector for doubles: sums of squared depths of 16 bits are exact.
template <class Visit>
HWY_INLINE void ForEachDoubles(int count, const Visit& visit) {
  const hn::CappedTag<double, 8> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) visit(d, x);
  for (; x < count; ++x) visit(hn::CappedTag<double, 1>(), x);
}

void Fit(const Depths& depths, const Planes& planes, double* scratch) {
  const int columns = depths.count + 2 * reach;
  double* const sum = scratch;
  double* const along = sum + columns;
  double* const square = along + columns;
  ForEachDoubles(columns, [&](auto d, int x) HWY_ATTR {
    const hn::Rebind<std::int32_t, decltype(d)> ints;
    const hn::Rebind<std::uint16_t, decltype(d)> words;
    const std::uint16_t* const middle = depths.row - reach + x;
    auto s = hn::Zero(d);
    auto sy = s;
    auto s2 = s;
    for (int dy = -reach; dy <= reach; ++dy) {
      const auto z =
          hn::PromoteTo(d, hn::PromoteTo(ints, hn::LoadU(words, middle + dy * depths.pitch)));
      s = hn::Add(s, z);
      if (dy != 0) sy = hn::MulAdd(hn::Set(d, dy), z, sy);
      s2 = hn::MulAdd(z, z, s2);
    }
    hn::StoreU(s, d, sum + x);
    hn::StoreU(sy, d, along + x);
    hn::StoreU(s2, d, square + x);
  });
  const double unit_m = depths.unit_m;
  ForEachDoubles(depths.count, [&](auto d, int x) HWY_ATTR {
    auto s = hn::Zero(d);
    auto sx = s;
    auto sy = s;
    auto s2 = s;
    for (int dx = 0; dx < side; ++dx) {
      const auto column = hn::LoadU(d, sum + x + dx);
      s = hn::Add(s, column);
      if (dx != reach) sx = hn::MulAdd(hn::Set(d, dx - reach), column, sx);
      sy = hn::Add(sy, hn::LoadU(d, along + x + dx));
      s2 = hn::Add(s2, hn::LoadU(d, square + x + dx));
    }
    const auto mean = hn::Mul(s, hn::Set(d, 1 / pixels));
    const auto slope_x = hn::Mul(sx, hn::Set(d, 1 / squares));
    const auto slope_y = hn::Mul(sy, hn::Set(d, 1 / squares));
    const auto explained = hn::MulAdd(s, mean, hn::MulAdd(sx, slope_x, hn::Mul(sy, slope_y)));
    // Rounding to steps is noise, too: a twelfth.
    const auto variance = hn::MulAdd(hn::Max(hn::Sub(s2, explained), hn::Zero(d)),
                                     hn::Set(d, 1 / (pixels - 3)), hn::Set(d, 1. / 12));
    const auto usual = hn::MulAdd(hn::Mul(mean, mean), hn::Set(d, depths.noise.by_square * unit_m),
                                  hn::Set(d, depths.noise.constant_m / unit_m));
    const hn::Rebind<float, decltype(d)> floats;
    hn::StoreU(hn::DemoteTo(floats, mean), floats, planes.depth + x);
    hn::StoreU(hn::DemoteTo(floats, slope_x), floats, planes.slope_x + x);
    hn::StoreU(hn::DemoteTo(floats, slope_y), floats, planes.slope_y + x);
    hn::StoreU(hn::DemoteTo(floats, hn::Div(variance, hn::Mul(usual, usual))), floats,
               planes.variance + x);
  });
}

void AddUp(const Windows& windows, float half_variance, int count, const Sums& sums,
           float* scratch) {
  const int columns = count + 2 * reach;
  float* const weight = scratch;
  float* const depth = weight + columns;
  float* const slope_x = depth + columns;
  float* const slope_y = slope_x + columns;
  const int skipped = reach + windows.first;
  for (float* const row : {weight, depth, slope_x, slope_y}) {
    std::fill_n(row, skipped, 0.F);
    std::fill(row + skipped + windows.count, row + columns, 0.F);
  }
  ForEachVector(windows.count, [&](auto d, int x) HWY_ATTR {
    const auto one = hn::Set(d, 1.F);
    const auto relative =
        hn::Mul(hn::LoadU(d, windows.planes.variance + x), hn::Set(d, 1 / half_variance));
    const auto square = hn::Mul(relative, relative);
    const auto w = hn::Div(one, hn::MulAdd(square, square, one));
    hn::StoreU(w, d, weight + skipped + x);
    const auto weigh = [&](const float* values, float* to) HWY_ATTR {
      hn::StoreU(hn::Mul(w, hn::LoadU(d, values + x)), d, to + skipped + x);
    };
    weigh(windows.planes.depth, depth);
    weigh(windows.planes.slope_x, slope_x);
    weigh(windows.planes.slope_y, slope_y);
  });
  ForEachVector(count, [&](auto d, int x) HWY_ATTR {
    auto w = hn::Zero(d);
    auto z = w;
    auto slope = w;
    for (int dx = 0; dx < side; ++dx) {
      w = hn::Add(w, hn::LoadU(d, weight + x + dx));
      z = hn::Add(z, hn::LoadU(d, depth + x + dx));
      // Seen from the window, the pixel lies on the other side.
      if (dx != reach) {
        z = hn::MulAdd(hn::Set(d, static_cast<float>(reach - dx)), hn::LoadU(d, slope_x + x + dx),
                       z);
      }
      slope = hn::Add(slope, hn::LoadU(d, slope_y + x + dx));
    }
    hn::StoreU(w, d, sums.weight + x);
    hn::StoreU(z, d, sums.depth + x);
    hn::StoreU(slope, d, sums.slope + x);
  });
}

void Mix(const Around& around, int count, std::uint16_t* depth) {
  ForEachVector(count, [&](auto d, int x) HWY_ATTR {
    const hn::RebindToSigned<decltype(d)> ints;
    const hn::Rebind<std::uint16_t, decltype(d)> words;
    const auto own = hn::ConvertTo(d, hn::PromoteTo(ints, hn::LoadU(words, depth + x)));
    auto w = hn::Set(d, own_weight);
    auto z = hn::Mul(own, w);
    for (int k = 0; k < around.count; ++k) {
      const Sums& row = around.rows[static_cast<std::size_t>(k)];
      w = hn::Add(w, hn::LoadU(d, row.weight + x));
      z = hn::Add(z, hn::LoadU(d, row.depth + x));
      z = hn::MulAdd(hn::Set(d, static_cast<float>(-around.first - k)), hn::LoadU(d, row.slope + x),
                     z);
    }
    const auto mean = hn::Add(hn::Div(z, w), hn::Set(d, 0.5F));
    const auto mixed = hn::IfThenElseZero(hn::Gt(own, hn::Zero(d)), mean);
    hn::StoreU(hn::DemoteTo(words, TruncateSmall(mixed)), words, depth + x);
  });
}

}  // namespace
}  // namespace diminish::plane_windows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish::plane_windows {
namespace {

HWY_EXPORT(Fit);
HWY_EXPORT(AddUp);
HWY_EXPORT(Mix);

}  // namespace

void fit(const Depths& depths, const Planes& planes, double* scratch) {
  HWY_DYNAMIC_DISPATCH(Fit)(depths, planes, scratch);
}
void add_up(const Windows& windows, float half_variance, int count, const Sums& sums,
            float* scratch) {
  HWY_DYNAMIC_DISPATCH(AddUp)(windows, half_variance, count, sums, scratch);
}
void mix(const Around& around, int count, std::uint16_t* depth) {
  HWY_DYNAMIC_DISPATCH(Mix)(around, count, depth);
}

}  // namespace diminish::plane_windows
#endif
