#include "estimate/plane_sweep/candidate_choice.h"

#include <algorithm>

#include "estimate/plane_sweep/semi_global.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimate/plane_sweep/candidate_choice.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "estimate/plane_sweep/row_motion-inl.h"

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// In how many bits the codes of a row's pixels and of those in the other view differ.
void MatchCandidates(const Parallax& parallax, int y, const std::uint32_t* codes,
                     const float* inverse_depths, int count, const std::uint32_t* other, int width,
                     int height, std::uint8_t* costs) {
  ForEachPixelVector(count, [&](auto d, int x) HWY_ATTR {
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

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(MatchCandidates);

/// The square around a pixel whose census decides.
constexpr int reach = 2;

/// The coarse pixels on both sides of a fine one: its own, and the next nearest.
struct Pair {
  int own, next;
};
Pair coarse_pixels(int fine, int count) {
  const int own = std::min(fine / 2, count - 1);
  return {own, std::clamp(own + (fine % 2 == 0 ? -1 : 1), 0, count - 1)};
}

}  // namespace

void CandidateChoice::choose(const FineViews& views, const SweepPlanes& planes,
                             const Image<float>& coarse, Image<float>& inverse_depth) {
  const int width = views.reference.width();
  const int height = views.reference.height();
  inverse_depth.resize(width, height);
  for (Image<std::uint8_t>& costs : costs_) costs.resize(width, height);
  for (auto& column : columns_) column.resize(static_cast<std::size_t>(width));
  for (int x = 0; x < width; ++x) {
    const Pair columns = coarse_pixels(x, coarse.width());
    columns_[0][static_cast<std::size_t>(x)] = columns.own;
    columns_[1][static_cast<std::size_t>(x)] = columns.next;
  }
  // The inverse depths of the two coarse rows beside a fine one; 0 where nothing is known
  const auto load_rows = [&](int y, Scratch& scratch) {
    const Pair rows = coarse_pixels(y, coarse.height());
    for (std::size_t i = 0; i < 2; ++i) {
      std::vector<float>& depths = scratch.coarse_rows[i];
      depths.resize(static_cast<std::size_t>(coarse.width()));
      const float* const planes_of_row = coarse.row(i == 0 ? rows.own : rows.next);
      for (std::size_t x = 0; x < depths.size(); ++x) {
        const float plane = planes_of_row[x];
        depths[x] = plane == SemiGlobalMatching::none ? 0.F : planes.inverse_depth(plane);
      }
    }
  };
  for_rows(height, [&](Rows rows) {
    Scratch& scratch = scratch_[rows.band];
    std::vector<float>& depths = scratch.inverse_depths;
    depths.resize(static_cast<std::size_t>(width));
    for (int y = rows.first; y < rows.last; ++y) {
      load_rows(y, scratch);
      for (std::size_t number = 0; number < candidates; ++number) {
        const float* const known = scratch.coarse_rows[number / 2].data();
        const int* const columns = columns_[number % 2].data();
        for (std::size_t x = 0; x < depths.size(); ++x) depths[x] = known[columns[x]];
        HWY_DYNAMIC_DISPATCH(MatchCandidates)
        (views.parallax, y, views.reference_census.row(y), depths.data(), width,
         views.other_census.data(), views.other_census.width(), views.other_census.height(),
         costs_[number].row(y));
      }
    }
  });
  for_rows(height, [&](Rows rows) {
    Scratch& scratch = scratch_[rows.band];
    for (auto& columns : scratch.columns) {
      columns.assign(static_cast<std::size_t>(width) + std::size_t{2} * reach, 0);
    }
    for (auto& sums : scratch.sums) sums.resize(static_cast<std::size_t>(width));
    for (int y = rows.first; y < rows.last; ++y) {
      for (std::size_t number = 0; number < candidates; ++number) {
        std::uint16_t* const columns = scratch.columns[number].data() + reach;
        move_window(y, y == rows.first, reach, height, [&](int row, int sign) {
          const std::uint8_t* const added = costs_[number].row(row);
          for (int x = 0; x < width; ++x) {
            columns[x] = static_cast<std::uint16_t>(columns[x] + sign * added[x]);
          }
        });
        add_columns<reach>(scratch.columns[number].data(), width, scratch.sums[number].data());
      }
      load_rows(y, scratch);
      float* const chosen = inverse_depth.row(y);
      for (int x = 0; x < width; ++x) {
        const auto i = static_cast<std::size_t>(x);
        float best = 0;
        int least = 1 << 16;
        for (std::size_t number = 0; number < candidates; ++number) {
          const int cost = scratch.sums[number][i];
          const auto column = static_cast<std::size_t>(columns_[number % 2][i]);
          const float depth = scratch.coarse_rows[number / 2][column];
          const bool is_better = cost < least && depth > 0;
          best = is_better ? depth : best;
          least = is_better ? cost : least;
        }
        chosen[x] = best;
      }
    }
  });
}

}  // namespace diminish
#endif
