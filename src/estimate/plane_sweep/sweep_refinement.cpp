#include "estimate/plane_sweep/sweep_refinement.h"

#include <algorithm>
#include <cmath>

#include "core/rows.h"
#include "estimate/plane_sweep/census.h"
#include "estimate/plane_sweep/semi_global.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimate/plane_sweep/sweep_refinement.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Visits a row one vector at a time, and the rest pixel by pixel.
template <class Visit>
HWY_INLINE void ForEachVector(int count, const Visit& visit) {
  const hn::CappedTag<float, 8> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) visit(d, x);
  for (; x < count; ++x) visit(hn::CappedTag<float, 1>(), x);
}

/// Where the other view shows pixels x, x + 1, .. of row y that have these inverse depths.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void Move(D d, const Parallax& parallax, int x, int y, V inverse_depth, V& u, V& v) {
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

/// In how many bits the codes of a row's pixels and of those in the other view differ.
void MatchRow(const Parallax& parallax, int y, const std::uint32_t* codes,
              const float* inverse_depths, int count, const std::uint32_t* other, int width,
              int height, std::uint8_t* costs) {
  ForEachVector(count, [&](auto d, int x) HWY_ATTR {
    const hn::RebindToSigned<decltype(d)> di;
    const hn::RebindToUnsigned<decltype(d)> du;
    const hn::Rebind<std::uint8_t, decltype(d)> d8;
    const auto inverse_depth = hn::LoadU(d, inverse_depths + x);
    auto u = hn::Zero(d);
    auto v = hn::Zero(d);
    Move(d, parallax, x, y, inverse_depth, u, v);
    const auto inside = [&](auto value, int end) HWY_ATTR {
      return hn::And(hn::Ge(value, hn::Zero(d)),
                     hn::Le(value, hn::Set(d, static_cast<float>(end - 1))));
    };
    const auto in_view =
        hn::And(hn::And(inside(u, width), inside(v, height)), hn::Gt(inverse_depth, hn::Zero(d)));
    const auto column = hn::NearestInt(hn::IfThenElseZero(in_view, u));
    const auto row = hn::NearestInt(hn::IfThenElseZero(in_view, v));
    const auto at = hn::Add(hn::Mul(row, hn::Set(di, width)), column);
    const auto other_codes = hn::GatherIndex(du, other, at);
    const auto bits = hn::PopulationCount(hn::Xor(other_codes, hn::LoadU(du, codes + x)));
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(di, bits)), d8, costs + x);
  });
}

/// Brightness between pixels of the other view; below 0 out of view.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V LookUp(D d, const std::uint8_t* other, int width, int height, V u, V v) {
  const hn::RebindToSigned<D> di;
  const hn::RebindToUnsigned<D> du;
  // Four bytes are read at once: two pixels and what follows.
  const auto in_view = hn::And(
      hn::And(hn::Ge(u, hn::Zero(d)), hn::Lt(u, hn::Set(d, static_cast<float>(width - 4)))),
      hn::And(hn::Ge(v, hn::Zero(d)), hn::Lt(v, hn::Set(d, static_cast<float>(height - 2)))));
  const auto inside_u = hn::IfThenElseZero(in_view, u);
  const auto inside_v = hn::IfThenElseZero(in_view, v);
  const auto column = hn::ConvertTo(di, inside_u);
  const auto row = hn::ConvertTo(di, inside_v);
  const auto right = hn::Sub(inside_u, hn::ConvertTo(d, column));
  const auto down = hn::Sub(inside_v, hn::ConvertTo(d, row));
  const auto at = hn::Add(hn::Mul(row, hn::Set(di, width)), column);
  const auto byte = hn::Set(du, 255U);
  const auto* const words = reinterpret_cast<const std::uint32_t*>(other);
  const auto blend = [&](auto offset) HWY_ATTR {
    const auto four = hn::GatherOffset(du, words, offset);
    const auto left_level = hn::ConvertTo(d, hn::BitCast(di, hn::And(four, byte)));
    const auto right_level =
        hn::ConvertTo(d, hn::BitCast(di, hn::And(hn::ShiftRight<8>(four), byte)));
    return hn::Add(left_level, hn::Mul(right, hn::Sub(right_level, left_level)));
  };
  const auto upper = blend(at);
  const auto lower = blend(hn::Add(at, hn::Set(di, width)));
  const auto level = hn::Add(upper, hn::Mul(down, hn::Sub(lower, upper)));
  return hn::IfThenElse(in_view, level, hn::Set(d, -1.F));
}

/// For a row's pixels: how much brighter the reference is than the other view, and by how much the
/// other view's brightness grows with a step of inverse depth; 0 where that is not known.
void CompareRow(const Parallax& parallax, float step, int y, const std::uint8_t* reference,
                const float* inverse_depths, int count, const std::uint8_t* other, int width,
                int height, float* differences, float* slopes) {
  ForEachVector(count, [&](auto d, int x) HWY_ATTR {
    const hn::Rebind<std::uint8_t, decltype(d)> d8;
    const hn::RebindToSigned<decltype(d)> di;
    const auto inverse_depth = hn::LoadU(d, inverse_depths + x);
    const auto level_at = [&](auto at) HWY_ATTR {
      auto u = hn::Zero(d);
      auto v = hn::Zero(d);
      Move(d, parallax, x, y, at, u, v);
      return LookUp(d, other, width, height, u, v);
    };
    const auto half = hn::Set(d, step / 2);
    const auto own = hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(d8, reference + x)));
    const auto here = level_at(inverse_depth);
    const auto nearer = level_at(hn::Add(inverse_depth, half));
    const auto farther = level_at(hn::Sub(inverse_depth, half));
    const auto one = hn::Set(d, 1.F);
    const auto known = hn::And(hn::And(hn::Ge(hn::Min(nearer, farther), one), hn::Ge(here, one)),
                               hn::And(hn::Ge(own, one), hn::Gt(inverse_depth, hn::Zero(d))));
    hn::StoreU(hn::IfThenElseZero(known, hn::Sub(own, here)), d, differences + x);
    hn::StoreU(hn::IfThenElseZero(known, hn::Sub(nearer, farther)), d, slopes + x);
  });
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(MatchRow);
HWY_EXPORT(CompareRow);

/// The square around a pixel whose census decides, and the one whose gradients count.
constexpr int census_reach = 2;
constexpr int gradient_reach = 4;
constexpr int iterations = 2;
/// Of the smoothing: pixels of a surface differ by less, and how far they count.
constexpr float tolerance_px = 3;
constexpr int widest_px = 2;

/// The coarse pixels on both sides of a fine one: its own, and the next nearest.
struct Pair {
  int own, next;
};
Pair coarse_pixels(int fine, int count) {
  const int own = std::min(fine / 2, count - 1);
  return {own, std::clamp(own + (fine % 2 == 0 ? -1 : 1), 0, count - 1)};
}

/// Sums of `rows` consecutive rows become sums of squares, column by column.
template <class Number>
void sum_along(const std::vector<Number>& columns, int count, int reach,
               std::vector<Number>& sums) {
  Number sum = 0;
  const auto at = [&](int x) { return columns[static_cast<std::size_t>(x)]; };
  for (int x = 0; x < std::min(reach, count); ++x) sum += at(x);
  for (int x = 0; x < count; ++x) {
    if (x + reach < count) sum += at(x + reach);
    sums[static_cast<std::size_t>(x)] = sum;
    if (x - reach >= 0) sum -= at(x - reach);
  }
}

}  // namespace

void SweepRefinement::choose(const FineViews& views, const SweepPlanes& planes,
                             const Image<float>& coarse, Image<float>& inverse_depth) {
  const int width = views.reference.width();
  const int height = views.reference.height();
  for (Image<std::uint8_t>& costs : costs_) costs.resize(width, height);
  const auto candidate = [&](std::size_t number, Pair columns, Pair rows) {
    const float plane = coarse(number % 2 == 0 ? columns.own : columns.next,
                               number / 2 == 0 ? rows.own : rows.next);
    return plane == SemiGlobalMatching::none ? 0.F : planes.inverse_depth(plane);
  };
  for_rows(height, [&](Rows rows) {
    std::vector<float> depths(static_cast<std::size_t>(width));
    for (int y = rows.first; y < rows.last; ++y) {
      const Pair coarse_rows = coarse_pixels(y, coarse.height());
      for (std::size_t number = 0; number < costs_.size(); ++number) {
        for (int x = 0; x < width; ++x) {
          depths[static_cast<std::size_t>(x)] =
              candidate(number, coarse_pixels(x, coarse.width()), coarse_rows);
        }
        HWY_DYNAMIC_DISPATCH(MatchRow)
        (views.parallax, y, views.reference_census.row(y), depths.data(), width,
         views.other_census.data(), views.other_census.width(), views.other_census.height(),
         costs_[number].row(y));
      }
    }
  });
  for_rows(height, [&](Rows rows) {
    std::vector<int> columns(static_cast<std::size_t>(width));
    std::vector<int> sums(columns.size());
    std::vector<int> best(columns.size());
    for (int y = rows.first; y < rows.last; ++y) {
      const Pair coarse_rows = coarse_pixels(y, coarse.height());
      const int first = std::max(0, y - census_reach);
      const int last = std::min(height - 1, y + census_reach);
      for (std::size_t number = 0; number < costs_.size(); ++number) {
        std::fill(columns.begin(), columns.end(), 0);
        for (int row = first; row <= last; ++row) {
          const std::uint8_t* const costs = costs_[number].row(row);
          for (int x = 0; x < width; ++x) columns[static_cast<std::size_t>(x)] += costs[x];
        }
        sum_along(columns, width, census_reach, sums);
        for (int x = 0; x < width; ++x) {
          const float depth = candidate(number, coarse_pixels(x, coarse.width()), coarse_rows);
          const auto i = static_cast<std::size_t>(x);
          float& chosen = inverse_depth(x, y);
          if (number == 0) {
            chosen = depth;
            best[i] = sums[i];
          } else if (depth > 0 && (sums[i] < best[i] || !(chosen > 0))) {
            chosen = depth;
            best[i] = sums[i];
          }
        }
      }
    }
  });
}

void SweepRefinement::follow_gradient(const FineViews& views, float step,
                                      Image<float>& inverse_depth) {
  const int width = views.reference.width();
  const int height = views.reference.height();
  difference_.resize(width, height);
  slope_.resize(width, height);
  for_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      HWY_DYNAMIC_DISPATCH(CompareRow)
      (views.parallax, step, y, views.reference.row(y), inverse_depth.row(y), width,
       views.other.data(), views.other.width(), views.other.height(), difference_.row(y),
       slope_.row(y));
    }
  });
  for_rows(height, [&](Rows rows) {
    // Of the square around each pixel: how many count, differences, slopes, products, squares
    std::array<std::vector<float>, 5> columns;
    std::array<std::vector<float>, 5> sums;
    for (auto& sum : sums) sum.resize(static_cast<std::size_t>(width));
    for (int y = rows.first; y < rows.last; ++y) {
      for (auto& column : columns) column.assign(static_cast<std::size_t>(width), 0.F);
      const int last = std::min(height - 1, y + gradient_reach);
      for (int row = std::max(0, y - gradient_reach); row <= last; ++row) {
        const float* const difference = difference_.row(row);
        const float* const slope = slope_.row(row);
        for (int x = 0; x < width; ++x) {
          const auto i = static_cast<std::size_t>(x);
          columns[0][i] += difference[x] != 0 || slope[x] != 0 ? 1.F : 0.F;
          columns[1][i] += difference[x];
          columns[2][i] += slope[x];
          columns[3][i] += difference[x] * slope[x];
          columns[4][i] += slope[x] * slope[x];
        }
      }
      for (std::size_t k = 0; k < columns.size(); ++k) {
        sum_along(columns[k], width, gradient_reach, sums[k]);
      }
      float* const depths = inverse_depth.row(y);
      for (int x = 0; x < width; ++x) {
        const auto i = static_cast<std::size_t>(x);
        const float count = std::max(1.F, sums[0][i]);
        const float product = sums[3][i] - sums[1][i] * sums[2][i] / count;
        const float square = sums[4][i] - sums[2][i] * sums[2][i] / count;
        // Levels a step, of a pixel: less than noise has does not tell.
        constexpr float least_slope = 1.5F;
        if (!(depths[x] > 0) || square < count * least_slope * least_slope) continue;
        depths[x] += step * std::clamp(product / square, -1.F, 1.F);
      }
    }
  });
}

void SweepRefinement::refine(const FineViews& views, const SweepPlanes& planes,
                             const Image<float>& coarse, Image<float>& inverse_depth) {
  inverse_depth.resize(views.reference.width(), views.reference.height());
  choose(views, planes, coarse, inverse_depth);
  // A step of a pixel in the middle of the range
  const float middle = planes.inverse_depth(static_cast<float>(planes.count) / 2);
  const float step =
      planes.step / std::max(1e-6F, views.parallax.path_px(middle, middle + planes.step));
  const float tolerance = tolerance_px * step;
  for (int i = 0; i < iterations; ++i) {
    smoothing_.smooth(tolerance, widest_px, inverse_depth);
    follow_gradient(views, step, inverse_depth);
  }
  smoothing_.smooth(tolerance, widest_px, inverse_depth);
}

}  // namespace diminish
#endif
