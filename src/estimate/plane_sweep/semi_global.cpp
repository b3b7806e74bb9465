#include "estimate/plane_sweep/semi_global.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/tasks.h"
#include "estimate/plane_sweep/census.h"

#ifndef DIMINISH_ESTIMATE_SEMI_GLOBAL_CONSTANTS
#define DIMINISH_ESTIMATE_SEMI_GLOBAL_CONSTANTS
namespace diminish {
namespace {

/// Planes of a pixel are padded to multiples of this; room on both sides of a path's costs.
constexpr int block = 32;
/// The cost of a plane that does not exist; no sum of others is as large.
constexpr std::uint8_t too_much = 255;
/// What a path pays for going to the next plane, in census bits.
constexpr std::uint8_t next_plane = 3;

/// What a path pays for going further, by how much brightness changes: little at an edge. At most
/// 31: four paths' costs, with a census's most bits each, fit into a byte.
constexpr std::array<std::uint8_t, 256> far_plane = [] {
  constexpr int most = 30;
  constexpr int least = 20;
  constexpr int edge = 12;
  std::array<std::uint8_t, 256> cost{};
  for (int change = 0; change < 256; ++change) {
    cost[static_cast<std::size_t>(change)] =
        static_cast<std::uint8_t>(std::max(least, most * edge / (edge + change)));
  }
  return cost;
}();

/// A path's next pixel.
struct PathStep {
  const std::uint8_t* costs;
  std::uint8_t* sums;
  const std::uint8_t* before;  ///< the path's costs at the pixel before
  std::uint8_t* path;          ///< those at this pixel
  std::uint8_t least;          ///< of `before`; then of `path`
  std::uint8_t far;            ///< what it pays for going further than to the next plane
  bool add;                    ///< to the sums, which other paths have begun
};

/// A path's memory: the costs of one pixel, with `too_much` on both sides.
constexpr int path_pitch(int pitch) {
  return pitch + 2 * block;
}

}  // namespace
}  // namespace diminish
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimate/plane_sweep/semi_global.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::CappedTag<std::uint8_t, block>;

/// The least of all lanes, in each lane.
HWY_INLINE hn::Vec<Bytes> LeastOfAll(hn::Vec<Bytes> v) {
#if HWY_TARGET != HWY_SCALAR
  const Bytes d;
  v = hn::Min(v, hn::CombineShiftRightBytes<8>(d, v, v));
  v = hn::Min(v, hn::CombineShiftRightBytes<4>(d, v, v));
  v = hn::Min(v, hn::CombineShiftRightBytes<2>(d, v, v));
  v = hn::Min(v, hn::CombineShiftRightBytes<1>(d, v, v));
  v = hn::Min(v, hn::SwapAdjacentBlocks(v));
#endif
  return v;
}

/// In how many bits a pixel's code differs from those in the other view, plane by plane. shift: so
/// that planes out of view lie at negative columns.
HWY_INLINE void MatchPixel(std::uint32_t code, float x, const std::uint32_t* other, int width,
                           const float* scale, const float* shift, const std::int32_t* row,
                           int pitch, std::uint8_t* costs) {
  const hn::CappedTag<float, 16> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const hn::Rebind<std::uint8_t, decltype(d)> d8;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto own = hn::Set(du, code);
  for (int k = 0; k < pitch; k += lanes) {
    const auto u =
        hn::Add(hn::Mul(hn::Set(d, x), hn::LoadU(d, scale + k)), hn::LoadU(d, shift + k));
    const auto column = hn::NearestInt(u);
    const auto in_view =
        hn::And(hn::Gt(column, hn::Set(di, -1)), hn::Lt(column, hn::Set(di, width)));
    const auto at = hn::IfThenElseZero(in_view, hn::Add(hn::LoadU(di, row + k), column));
    const auto codes = hn::GatherIndex(du, other, at);
    const auto bits = hn::PopulationCount(hn::Xor(codes, own));
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(di, bits)), d8, costs + k);
  }
}

/// A row's pixels, `pitch` costs each, of which the first `count` are planes'.
void MatchRow(const std::uint32_t* codes, int pixels, const std::uint32_t* other, int width,
              const float* scale, const float* shift, const std::int32_t* row, int count, int pitch,
              std::uint8_t* costs) {
  for (int x = 0; x < pixels; ++x, costs += pitch) {
    MatchPixel(codes[x], static_cast<float>(x), other, width, scale, shift, row, pitch, costs);
    std::fill(costs + count, costs + pitch, too_much);
  }
}

/// The path's costs at a pixel from those at the pixel before it. before, path: of `path_pitch`,
/// from the first plane on. Returns their least. Adds them to the pixel's sums.
template <bool add>
HWY_INLINE std::uint8_t Follow(const PathStep& step, int pitch) {
  const Bytes d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto base = hn::Set(d, step.least);
  const auto limit = hn::SaturatedAdd(base, hn::Set(d, step.far));
  const auto next = hn::Set(d, next_plane);
  auto least = hn::Set(d, too_much);
  for (int k = 0; k < pitch; k += lanes) {
    const auto beside =
        hn::Min(hn::LoadU(d, step.before + k - 1), hn::LoadU(d, step.before + k + 1));
    const auto best =
        hn::Min(hn::Min(hn::LoadU(d, step.before + k), hn::SaturatedAdd(beside, next)), limit);
    const auto cost = hn::SaturatedAdd(hn::LoadU(d, step.costs + k), hn::Sub(best, base));
    hn::StoreU(cost, d, step.path + k);
    least = hn::Min(least, cost);
    hn::StoreU(add ? hn::SaturatedAdd(hn::LoadU(d, step.sums + k), cost) : cost, d, step.sums + k);
  }
  return hn::GetLane(LeastOfAll(least));
}

/// A path's pixel waits for the one before it. Several paths fill the time.
void FollowPaths(PathStep* steps, int count, int pitch) {
  for (PathStep* step = steps; step < steps + count; ++step) {
    step->least = step->add ? Follow<true>(*step, pitch) : Follow<false>(*step, pitch);
  }
}

/// The first of the planes with the least sum.
HWY_INLINE int FindLeast(const std::uint8_t* sums, int pitch) {
  const Bytes d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  auto least = hn::LoadU(d, sums);
  for (int k = lanes; k < pitch; k += lanes) least = hn::Min(least, hn::LoadU(d, sums + k));
  least = LeastOfAll(least);
  for (int k = 0; k < pitch; k += lanes) {
    const auto first = hn::FindFirstTrue(d, hn::Eq(hn::LoadU(d, sums + k), least));
    if (first >= 0) return k + static_cast<int>(first);
  }
  return 0;
}

/// From the costs of the best plane and of those beside it: where between them the least lies.
HWY_INLINE float Between(int before, int best, int after) {
  const int bend = before + after - 2 * best;
  return bend > 0 ? 0.5F * static_cast<float>(before - after) / static_cast<float>(bend) : 0.F;
}

/// The best plane of each of a row's pixels, if it is clearly better than all but its neighbours.
/// Changes `sums`.
void ChoosePlanes(std::uint8_t* sums, int pixels, int count, int pitch, float* found) {
  for (int i = 0; i < pixels; ++i, sums += pitch) {
    const int best = FindLeast(sums, pitch);
    found[i] = SemiGlobalMatching::none;
    // At the ends of the range the least may lie beyond it.
    if (best == 0 || best >= count - 1) continue;
    const int cost = sums[best];
    const float plane = static_cast<float>(best) + Between(sums[best - 1], cost, sums[best + 1]);
    std::fill_n(sums + best - 1, 3, too_much);
    const int second = sums[FindLeast(sums, pitch)];
    constexpr int better_by = 2;
    if (second - cost >= better_by) found[i] = plane;
  }
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(MatchRow);
HWY_EXPORT(FollowPaths);
HWY_EXPORT(ChoosePlanes);

/// Rows whose paths are followed together, each in both directions.
constexpr int rows_together = 2;
constexpr int columns_together = 32;

std::uint8_t far_plane_between(std::uint8_t a, std::uint8_t b) {
  return far_plane[static_cast<std::size_t>(std::abs(a - b))];
}

/// A path's costs at its pixel number i and at the one before, which take turns in its memory.
class PathCosts {
 public:
  static std::size_t size(int pitch) { return 2 * static_cast<std::size_t>(path_pitch(pitch)); }

  PathCosts() = default;
  PathCosts(std::uint8_t* memory, int pitch) : memory_(memory), pitch_(pitch) {}

  void begin() {
    std::fill_n(memory_, size(pitch_), too_much);
    // Nothing was paid before the first pixel.
    std::fill_n(here(1), pitch_, std::uint8_t{0});
  }
  std::uint8_t* here(int i) { return memory_ + std::ptrdiff_t{i % 2} * path_pitch(pitch_) + block; }
  std::uint8_t* before(int i) { return here(i + 1); }

 private:
  std::uint8_t* memory_ = nullptr;
  int pitch_ = 0;
};

}  // namespace

void SemiGlobalMatching::prepare(const MatchedViews& views, const SweepPlanes& planes) {
  width_ = views.reference.width();
  pitch_ = (planes.count + block - 1) / block * block;
  inverse_depths_.resize(static_cast<std::size_t>(pitch_));
  scales_.resize(inverse_depths_.size());
  for (int k = 0; k < pitch_; ++k) {
    const auto i = static_cast<std::size_t>(k);
    inverse_depths_[i] = planes.inverse_depth(static_cast<float>(k));
    scales_[i] = views.parallax.scale(inverse_depths_[i]);
  }
  const std::size_t size = at(0, views.reference.height());
  if (costs_.size() < size) {
    costs_.resize(size);
    sums_.resize(size);
  }
}

void SemiGlobalMatching::match(const MatchedViews& views, const SweepPlanes& planes,
                               Image<float>& found) {
  prepare(views, planes);
  found.resize(width_, views.reference.height());
  follow_rows(views, planes.count);
  follow_columns(views, planes.count, found);
}

/// Finds the costs, and follows the two paths along each row.
void SemiGlobalMatching::follow_rows(const MatchedViews& views, int count) {
  for_rows(
      views.reference.height(),
      [&](Rows rows) {
        Scratch& scratch = scratch_[rows.band];
        scratch.planes.shift.resize(scales_.size());
        scratch.planes.row.resize(scales_.size());
        scratch.paths.resize(2 * rows_together * PathCosts::size(pitch_));
        for (int y = rows.first; y < rows.last; y += rows_together) {
          const int together = std::min(rows_together, rows.last - y);
          for (int i = 0; i < together; ++i) match_row(views, count, y + i, scratch.planes);
          follow_rows_together(views, y, together, scratch);
        }
      },
      16);
}

void SemiGlobalMatching::match_row(const MatchedViews& views, int count, int y,
                                   RowOfPlanes& planes) {
  const int other_width = views.other_census.width();
  const int other_height = views.other_census.height();
  for (std::size_t k = 0; k < scales_.size(); ++k) {
    const float d = inverse_depths_[k];
    const float s = scales_[k];
    const auto v =
        static_cast<int>(std::nearbyint(static_cast<float>(y) * s + views.parallax.shift_y(d, s)));
    const bool in_view = v >= 0 && v < other_height;
    constexpr float out_of_view = -1e6F;
    planes.shift[k] = in_view ? views.parallax.shift_x(d, s) : out_of_view;
    planes.row[k] = in_view ? v * other_width : 0;
  }
  HWY_DYNAMIC_DISPATCH(MatchRow)
  (views.reference_census.row(y), width_, views.other_census.data(), other_width, scales_.data(),
   planes.shift.data(), planes.row.data(), count, pitch_, costs_.data() + at(0, y));
}

void SemiGlobalMatching::follow_rows_together(const MatchedViews& views, int y, int rows,
                                              Scratch& scratch) {
  constexpr int most = 2 * rows_together;
  std::array<PathStep, most> steps{};
  std::array<PathCosts, most> paths;
  for (std::size_t k = 0; k < most; ++k) {
    paths[k] = PathCosts(scratch.paths.data() + k * PathCosts::size(pitch_), pitch_);
    paths[k].begin();
  }
  for (int i = 0; i < width_; ++i) {
    for (int k = 0; k < 2 * rows; ++k) {
      const bool is_back = k % 2 != 0;
      const int row = y + k / 2;
      const int x = is_back ? width_ - 1 - i : i;
      const int last_x = i == 0 ? x : is_back ? x + 1 : x - 1;
      const std::uint8_t* const grey = views.reference.row(row);
      PathStep& step = steps[static_cast<std::size_t>(k)];
      PathCosts& path = paths[static_cast<std::size_t>(k)];
      step.costs = costs_.data() + at(x, row);
      step.sums = sums_.data() + at(x, row);
      step.before = path.before(i);
      step.path = path.here(i);
      step.far = far_plane_between(grey[x], grey[last_x]);
      // The other way's path has been here if it is beyond the middle.
      step.add = is_back ? 2 * i >= width_ - 1 : 2 * i > width_ - 1;
    }
    HWY_DYNAMIC_DISPATCH(FollowPaths)(steps.data(), 2 * rows, pitch_);
  }
}

/// Follows the two paths along each column, which complete the sums, and chooses.
void SemiGlobalMatching::follow_columns(const MatchedViews& views, int count, Image<float>& found) {
  const int height = views.reference.height();
  const int tasks = (width_ + columns_together - 1) / columns_together;
  column_scratch_.resize(static_cast<std::size_t>(tasks));
  for_tasks(static_cast<std::size_t>(tasks), [&](std::size_t task) {
    const int first = static_cast<int>(task) * columns_together;
    const auto columns = static_cast<std::size_t>(std::min(columns_together, width_ - first));
    Scratch& scratch = column_scratch_[task];
    const std::size_t size = PathCosts::size(pitch_);
    scratch.paths.resize(size * columns_together);
    std::array<PathCosts, columns_together> paths;
    for (const bool is_up : {false, true}) {
      std::array<PathStep, columns_together> steps{};
      for (std::size_t i = 0; i < columns; ++i) {
        paths[i] = PathCosts(scratch.paths.data() + i * size, pitch_);
        paths[i].begin();
        steps[i].add = true;
      }
      const std::uint8_t* last_grey = nullptr;
      for (int row = 0; row < height; ++row) {
        const int y = is_up ? height - 1 - row : row;
        const std::uint8_t* const grey = views.reference.row(y) + first;
        if (last_grey == nullptr) last_grey = grey;
        std::uint8_t* const sums = sums_.data() + at(first, y);
        const std::uint8_t* const costs = costs_.data() + at(first, y);
        for (std::size_t i = 0; i < columns; ++i) {
          PathStep& step = steps[i];
          step.costs = costs + i * static_cast<std::size_t>(pitch_);
          step.sums = sums + i * static_cast<std::size_t>(pitch_);
          step.before = paths[i].before(row);
          step.path = paths[i].here(row);
          step.far = far_plane_between(grey[i], last_grey[i]);
        }
        HWY_DYNAMIC_DISPATCH(FollowPaths)(steps.data(), static_cast<int>(columns), pitch_);
        if (is_up) {
          HWY_DYNAMIC_DISPATCH(ChoosePlanes)
          (sums, static_cast<int>(columns), count, pitch_, found.row(y) + first);
        }
        last_grey = grey;
      }
    }
  });
}

}  // namespace diminish
#endif
