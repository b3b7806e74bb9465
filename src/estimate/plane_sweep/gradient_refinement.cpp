#include "estimate/plane_sweep/gradient_refinement.h"

#include <algorithm>
#include <cmath>
#ifndef DIMINISH_ESTIMATE_GRADIENT_UNITS
#define DIMINISH_ESTIMATE_GRADIENT_UNITS
namespace diminish {
namespace {

/// Brightness is counted in whole parts of a level, so that sums are exact in any order. A square
/// of 81 products, each of two differences of up to 255 levels, fits into 31 bits.
constexpr int level_unit = 16;
constexpr std::int16_t unknown_difference = -32768;

}  // namespace
}  // namespace diminish
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimate/plane_sweep/gradient_refinement.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "estimate/plane_sweep/row_motion-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

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

/// For a row's pixels, in units of 1 / level_unit: how much brighter the reference is than the
/// other view, and by how much the other view's brightness grows with a step of inverse depth;
/// `unknown` and 0 where that is not known.
void CompareRow(const Parallax& parallax, float step, int y, const std::uint8_t* reference,
                const float* inverse_depths, int count, const std::uint8_t* other, int width,
                int height, std::int16_t* differences, std::int16_t* slopes) {
  ForEachPixelVector(count, [&](auto d, int x) HWY_ATTR {
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
    const auto nearer = level_at(hn::Add(inverse_depth, half));
    const auto farther = level_at(hn::Sub(inverse_depth, half));
    const auto one = hn::Set(d, 1.F);
    const auto here = hn::Mul(hn::Add(nearer, farther), hn::Set(d, 0.5F));
    const auto known = hn::And(hn::Ge(hn::Min(nearer, farther), one),
                               hn::And(hn::Ge(own, one), hn::Gt(inverse_depth, hn::Zero(d))));
    const hn::Rebind<std::int16_t, decltype(d)> d16;
    const auto unit = hn::Set(d, static_cast<float>(level_unit));
    const auto whole = [&](auto levels) HWY_ATTR {
      return hn::NearestInt(hn::IfThenElseZero(known, hn::Mul(levels, unit)));
    };
    const auto difference = hn::IfThenElse(hn::RebindMask(di, known), whole(hn::Sub(own, here)),
                                           hn::Set(di, unknown_difference));
    hn::StoreU(hn::DemoteTo(d16, difference), d16, differences + x);
    hn::StoreU(hn::DemoteTo(d16, whole(hn::Sub(nearer, farther))), d16, slopes + x);
  });
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(CompareRow);

/// The square around a pixel whose gradients count.
constexpr int refinement_reach = 4;

}  // namespace

/// Adds a row's pixels to the sums of its columns, or takes them away (sign -1).
void GradientRefinement::add_row(const std::int16_t* differences, const std::int16_t* slopes,
                                 int count, std::int32_t sign, Scratch& scratch) {
  std::int32_t* const numbers = scratch.columns[0].data() + refinement_reach;
  std::int32_t* const difference_sums = scratch.columns[1].data() + refinement_reach;
  std::int32_t* const slope_sums = scratch.columns[2].data() + refinement_reach;
  std::int32_t* const products = scratch.columns[3].data() + refinement_reach;
  std::int32_t* const squares = scratch.columns[4].data() + refinement_reach;
  for (int x = 0; x < count; ++x) {
    const bool known = differences[x] != unknown_difference;
    const std::int32_t difference = known ? sign * differences[x] : 0;
    const std::int32_t slope = slopes[x];
    numbers[x] += known ? sign : 0;
    difference_sums[x] += difference;
    slope_sums[x] += sign * slope;
    products[x] += difference * slope;
    squares[x] += sign * slope * slope;
  }
}

/// How far a row's pixels move, in steps: by the least squares of the brightness that is left.
void GradientRefinement::move_row(const Scratch& scratch, int count, float step,
                                  float* inverse_depths) {
  const std::int32_t* const numbers = scratch.sums[0].data();
  const std::int32_t* const differences = scratch.sums[1].data();
  const std::int32_t* const slopes = scratch.sums[2].data();
  const std::int32_t* const products = scratch.sums[3].data();
  const std::int32_t* const squares = scratch.sums[4].data();
  for (int x = 0; x < count; ++x) {
    const float number = static_cast<float>(std::max(1, numbers[x]));
    const auto slope = static_cast<float>(slopes[x]);
    const float product =
        static_cast<float>(products[x]) - static_cast<float>(differences[x]) * slope / number;
    const float square = static_cast<float>(squares[x]) - slope * slope / number;
    // Levels a step, of a pixel: less than noise has does not tell.
    constexpr float least_slope = 1.5F * level_unit;
    const bool tells = square >= number * least_slope * least_slope;
    const float move = step * std::clamp(product / std::max(square, 1.F), -1.F, 1.F);
    inverse_depths[x] += tells && inverse_depths[x] > 0 ? move : 0.F;
  }
}

void GradientRefinement::move(const FineViews& views, float step, Image<float>& inverse_depth) {
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
    Scratch& scratch = scratch_[rows.band];
    for (auto& columns : scratch.columns) {
      columns.assign(static_cast<std::size_t>(width) + std::size_t{2} * refinement_reach, 0);
    }
    for (auto& sums : scratch.sums) sums.resize(static_cast<std::size_t>(width));
    for (int y = rows.first; y < rows.last; ++y) {
      move_window(y, y == rows.first, refinement_reach, height, [&](int row, int sign) {
        add_row(difference_.row(row), slope_.row(row), width, sign, scratch);
      });
      for (std::size_t term = 0; term < terms; ++term) {
        add_columns<refinement_reach>(scratch.columns[term].data(), width,
                                      scratch.sums[term].data());
      }
      move_row(scratch, width, step, inverse_depth.row(y));
    }
  });
}

}  // namespace diminish
#endif
