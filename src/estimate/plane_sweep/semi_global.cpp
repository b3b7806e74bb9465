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

/// What a path pays for going further, if brightness changes by so much: little at an edge.
/// At most 31: four paths' costs, with a census's most bits each, fit into a byte.
inline std::uint8_t far_plane(int change) {
  constexpr int most = 30;
  constexpr int least = 20;
  constexpr int edge = 12;
  return static_cast<std::uint8_t>(std::max(least, most * edge / (edge + change)));
}

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
void MatchPixel(std::uint32_t code, float x, const std::uint32_t* other, int width,
                const float* scale, const float* shift, const std::int32_t* row, int pitch,
                std::uint8_t* costs) {
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

/// The path's costs at a pixel from those at the pixel before it. before, path: of `path_pitch`,
/// from the first plane on. Returns their least. Adds them to the pixel's sums.
HWY_INLINE std::uint8_t Step(const std::uint8_t* costs, const std::uint8_t* before,
                             std::uint8_t least_before, std::uint8_t far, int pitch,
                             std::uint8_t* path, std::uint8_t* sums, bool add) {
  const Bytes d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto base = hn::Set(d, least_before);
  const auto limit = hn::SaturatedAdd(base, hn::Set(d, far));
  const auto next = hn::Set(d, next_plane);
  auto least = hn::Set(d, too_much);
  for (int k = 0; k < pitch; k += lanes) {
    const auto beside = hn::Min(hn::LoadU(d, before + k - 1), hn::LoadU(d, before + k + 1));
    const auto best =
        hn::Min(hn::Min(hn::LoadU(d, before + k), hn::SaturatedAdd(beside, next)), limit);
    const auto cost = hn::SaturatedAdd(hn::LoadU(d, costs + k), hn::Sub(best, base));
    hn::StoreU(cost, d, path + k);
    least = hn::Min(least, cost);
    hn::StoreU(add ? hn::SaturatedAdd(hn::LoadU(d, sums + k), cost) : cost, d, sums + k);
  }
  return hn::GetLane(LeastOfAll(least));
}

std::uint8_t StepPath(const std::uint8_t* costs, const std::uint8_t* before,
                      std::uint8_t least_before, std::uint8_t far, int pitch, std::uint8_t* path,
                      std::uint8_t* sums, bool add) {
  return Step(costs, before, least_before, far, pitch, path, sums, add);
}

/// The first of the planes with the least sum.
int FindLeast(const std::uint8_t* sums, int pitch) {
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

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(MatchPixel);
HWY_EXPORT(StepPath);
HWY_EXPORT(FindLeast);

/// From the costs of the best plane and of those beside it: where between them the least lies.
float between(int before, int best, int after) {
  const int bend = before + after - 2 * best;
  return bend > 0 ? 0.5F * static_cast<float>(before - after) / static_cast<float>(bend) : 0.F;
}

/// The best plane of a pixel, if it is clearly better than all but its neighbours. Changes `sums`.
float choose(std::uint8_t* sums, int count, int pitch) {
  const int best = HWY_DYNAMIC_DISPATCH(FindLeast)(sums, pitch);
  // At the ends of the range the least may lie beyond it.
  if (best == 0 || best >= count - 1) return SemiGlobalMatching::none;
  const int cost = sums[best];
  const float plane = static_cast<float>(best) + between(sums[best - 1], cost, sums[best + 1]);
  std::fill_n(sums + best - 1, 3, too_much);
  const int second = sums[HWY_DYNAMIC_DISPATCH(FindLeast)(sums, pitch)];
  constexpr int better_by = 2;
  return second - cost >= better_by ? plane : SemiGlobalMatching::none;
}

int change(std::uint8_t a, std::uint8_t b) {
  return std::abs(a - b);
}

/// A path's costs at its pixel number i and at the one before, which take turns in its memory.
class PathCosts {
 public:
  static std::size_t size(int pitch) { return 2 * static_cast<std::size_t>(path_pitch(pitch)); }

  PathCosts(std::uint8_t* memory, int pitch) : memory_(memory), pitch_(pitch) {}

  void begin() {
    std::fill_n(memory_, size(pitch_), too_much);
    // Nothing was paid before the first pixel.
    std::fill_n(here(1), pitch_, std::uint8_t{0});
  }
  std::uint8_t* here(int i) { return memory_ + std::ptrdiff_t{i % 2} * path_pitch(pitch_) + block; }
  std::uint8_t* before(int i) { return here(i + 1); }

 private:
  std::uint8_t* memory_;
  int pitch_;
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
  const int other_width = views.other_census.width();
  const int other_height = views.other_census.height();
  for_rows(
      views.reference.height(),
      [&](Rows rows) {
        Scratch& scratch = scratch_[rows.band];
        scratch.planes.shift.resize(scales_.size());
        scratch.planes.row.resize(scales_.size());
        scratch.paths.resize(PathCosts::size(pitch_));
        for (int y = rows.first; y < rows.last; ++y) {
          for (std::size_t k = 0; k < scales_.size(); ++k) {
            const float d = inverse_depths_[k];
            const float s = scales_[k];
            const auto v = static_cast<int>(
                std::nearbyint(static_cast<float>(y) * s + views.parallax.shift_y(d, s)));
            const bool in_view = v >= 0 && v < other_height;
            constexpr float out_of_view = -1e6F;
            scratch.planes.shift[k] = in_view ? views.parallax.shift_x(d, s) : out_of_view;
            scratch.planes.row[k] = in_view ? v * other_width : 0;
          }
          for (int x = 0; x < width_; ++x) {
            std::uint8_t* const costs = costs_.data() + at(x, y);
            HWY_DYNAMIC_DISPATCH(MatchPixel)
            (views.reference_census(x, y), static_cast<float>(x), views.other_census.data(),
             other_width, scales_.data(), scratch.planes.shift.data(), scratch.planes.row.data(),
             pitch_, costs);
            std::fill(costs + count, costs + pitch_, too_much);
          }
          const std::uint8_t* const grey = views.reference.row(y);
          for (const bool is_back : {false, true}) {
            PathCosts path(scratch.paths.data(), pitch_);
            path.begin();
            std::uint8_t least = 0;
            int last_x = is_back ? width_ - 1 : 0;
            for (int i = 0; i < width_; ++i) {
              const int x = is_back ? width_ - 1 - i : i;
              least =
                  HWY_DYNAMIC_DISPATCH(StepPath)(costs_.data() + at(x, y), path.before(i), least,
                                                 far_plane(change(grey[x], grey[last_x])), pitch_,
                                                 path.here(i), sums_.data() + at(x, y), is_back);
              last_x = x;
            }
          }
        }
      },
      16);
}

/// Follows the two paths along each column, which complete the sums, and chooses.
void SemiGlobalMatching::follow_columns(const MatchedViews& views, int count, Image<float>& found) {
  const int height = views.reference.height();
  constexpr int columns_of_task = 32;
  const int tasks = (width_ + columns_of_task - 1) / columns_of_task;
  column_scratch_.resize(static_cast<std::size_t>(tasks));
  for_tasks(static_cast<std::size_t>(tasks), [&](std::size_t task) {
    const int first = static_cast<int>(task) * columns_of_task;
    const int columns = std::min(columns_of_task, width_ - first);
    Scratch& scratch = column_scratch_[task];
    const std::size_t size = PathCosts::size(pitch_);
    scratch.paths.resize(size * columns_of_task);
    std::array<std::uint8_t, columns_of_task> least{};
    for (const bool is_up : {false, true}) {
      const auto path = [&](int i) {
        return PathCosts(scratch.paths.data() + static_cast<std::size_t>(i) * size, pitch_);
      };
      for (int i = 0; i < columns; ++i) path(i).begin();
      least.fill(0);
      const std::uint8_t* last_grey = nullptr;
      for (int row = 0; row < height; ++row) {
        const int y = is_up ? height - 1 - row : row;
        const std::uint8_t* const grey = views.reference.row(y);
        if (last_grey == nullptr) last_grey = grey;
        for (int i = 0; i < columns; ++i) {
          const int x = first + i;
          const auto column = static_cast<std::size_t>(i);
          std::uint8_t* const sums = sums_.data() + at(x, y);
          least[column] = HWY_DYNAMIC_DISPATCH(StepPath)(
              costs_.data() + at(x, y), path(i).before(row), least[column],
              far_plane(change(grey[x], last_grey[x])), pitch_, path(i).here(row), sums, true);
          if (is_up) found(x, y) = choose(sums, count, pitch_);
        }
        last_grey = grey;
      }
    }
  });
}

}  // namespace diminish
#endif
