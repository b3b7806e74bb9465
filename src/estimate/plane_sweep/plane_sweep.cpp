#include "estimate/plane_sweep/plane_sweep.h"

#include <algorithm>
#include <cmath>

#include "core/tasks.h"
#include "estimate/plane_sweep/census.h"
#include "geometry/shrunk_camera.h"

namespace diminish {
namespace {

constexpr int least_planes = 8;
constexpr int most_planes = 256;
/// Of the depth image. The coarse view is half as large.
constexpr int coarse = 2;

/// Steps along the gradient, and how depths are smoothed between them: pixels of a surface differ
/// by less, and count as far as this.
constexpr int iterations = 2;
constexpr float tolerance_px = 3;
constexpr int widest_px = 2;

/// The smallest rectangle with even sides that contains this one.
Rect even(const Rect& rect) {
  const int x = rect.x - (rect.x & 1);
  const int y = rect.y - (rect.y & 1);
  return {x, y, (rect.right() - x + 1) / 2 * 2, (rect.bottom() - y + 1) / 2 * 2};
}

/// Planes a pixel of the coarse view apart; none if the other camera is beyond the range.
SweepPlanes spread(const Parallax& parallax, const PlaneSweep::Range& range) {
  SweepPlanes planes;
  planes.farthest = static_cast<float>(1 / range.farthest_m);
  auto nearest = static_cast<float>(1 / range.nearest_m);
  // What is hardly in front of the other camera is out of its sight.
  constexpr float least_of_distance = 0.2F;
  if (parallax.z < 0) nearest = std::min(nearest, (least_of_distance - 1) / parallax.z);
  if (nearest <= planes.farthest) return planes;
  const float path_px = parallax.path_px(planes.farthest, nearest);
  planes.count = std::clamp(static_cast<int>(std::ceil(path_px)) + 1, least_planes, most_planes);
  planes.step = (nearest - planes.farthest) / static_cast<float>(planes.count - 1);
  return planes;
}

void encode(const TurnedView& view, Image<std::uint32_t>& codes) {
  codes.resize(view.grey.width(), view.grey.height());
  census(view.grey, view.grey.bounds(), codes);
}

}  // namespace

void PlaneSweep::sweep(const GreyPicture& reference, const GreyPicture& other,
                       const RigidTransform& other_from_reference, const Range& range,
                       const Rect& part, Image<float>& inverse_depth) {
  // The other camera's place in the reference's frame is where both views are turned alike.
  const Eigen::Vector3d second_from_first =
      other_from_reference.rotation.transpose() * other_from_reference.translation;
  const Parallax parallax(view_, second_from_first);
  const Intrinsics small_view = shrunk_camera(view_, coarse);
  const Parallax small_parallax(small_view, second_from_first);
  planes_ = spread(small_parallax, range);
  inverse_depth.resize(view_.width, view_.height);
  if (part.empty() || planes_.count == 0) return find_nothing(inverse_depth);

  const Rect wanted = even(part);
  const float nearest = planes_.inverse_depth(static_cast<float>(planes_.count - 1));
  // A camera that looks elsewhere sees little of what its turned view could hold.
  const Rect useful = grow(view_.bounds(), 2 * std::max(view_.width, view_.height));
  const Rect reached =
      even(intersect(grow(parallax.reach(wanted, planes_.farthest, nearest), 8), useful));
  if (reached.empty()) return find_nothing(inverse_depth);
  do_all([&] { turn(reference, Eigen::Matrix3d::Identity(), view_, wanted, reference_); },
         [&] { turn(other, other_from_reference.rotation, view_, reached, other_); });
  do_all(
      [&] {
        encode(reference_, reference_census_);
        halve(reference_, small_reference_);
        encode(small_reference_, small_reference_census_);
      },
      [&] {
        encode(other_, other_census_);
        halve(other_, small_other_);
        encode(small_other_, small_other_census_);
      });
  matching_.match({small_reference_.grey, small_reference_census_, small_other_census_,
                   small_parallax.within(small_reference_.window, small_other_.window)},
                  planes_, coarse_);
  refine(parallax.within(reference_.window, other_.window));
  const Rect inside = intersect(wanted, view_.bounds());
  for (int y = inside.y; y < inside.bottom(); ++y) {
    const float* const found = fine_.row(y - wanted.y) + (inside.x - wanted.x);
    const std::uint8_t* const grey = reference_.grey.row(y - wanted.y) + (inside.x - wanted.x);
    float* const row = inverse_depth.row(y) + inside.x;
    for (int x = 0; x < inside.width; ++x) row[x] = grey[x] == unknown_grey ? 0 : found[x];
  }
}

void PlaneSweep::find_nothing(Image<float>& inverse_depth) {
  inverse_depth.fill(0);
  reference_.window = {};
}

void PlaneSweep::refine(const Parallax& parallax) {
  const FineViews views{reference_.grey, reference_census_, other_.grey, other_census_, parallax};
  choice_.choose(views, planes_, coarse_, fine_);
  // In the middle of the range
  const float middle = planes_.inverse_depth(static_cast<float>(planes_.count) / 2);
  const float step =
      planes_.step / std::max(1e-6F, parallax.path_px(middle, middle + planes_.step));
  for (int i = 0; i < iterations; ++i) {
    smoothing_.smooth(tolerance_px * step, widest_px, fine_);
    gradient_.move(views, step, fine_);
  }
  smoothing_.smooth(tolerance_px * step, widest_px, fine_);
}

}  // namespace diminish
