#include "memory/novelty.h"

#include <algorithm>
#include <limits>

#include "core/channels.h"
#include "core/rows.h"

namespace diminish {
namespace {

constexpr double always = -std::numeric_limits<double>::infinity();
/// Grid places that another one may be taken for, by errors of the poses.
constexpr int reach = 2;
constexpr float color_tolerance = 25;

}  // namespace

Novelty::Novelty(const KeyframeGrid& grid) : grid_(grid), lens_(Lens(grid.intrinsics())) {}

void Novelty::filter(bool is_uncertain, Keyframe& keyframe) {
  const int width = keyframe.depth.width();
  const int height = keyframe.depth.height();
  const bool is_first = depth_.empty();
  const FloatTransform then_from_now(
      is_first ? RigidTransform() : color_from_world_ * keyframe.color_from_world.inverse());
  const Rect inside = grow(keyframe.depth.bounds(), -reach);
  now_depth_ = keyframe.depth;
  now_color_.resize(width, height);
  now_since_s_.resize(width, height);
  const auto since = [&](int x, int y) {
    if (is_first || now_depth_(x, y) == 0) return always;
    const Eigen::Vector3f point = transform(then_from_now, grid_.point_m(x, y, now_depth_(x, y)));
    const auto pixel = project(lens_, point);
    const double unseen_before = is_uncertain ? keyframe.stamp_s : always;
    if (!pixel || !inside.contains(pixel->x, pixel->y)) return unseen_before;
    float least_m = 1e9F;
    float greatest_m = 0;
    Eigen::Array3f low = Eigen::Array3f::Constant(255);
    Eigen::Array3f high = Eigen::Array3f::Zero();
    for (int row = pixel->y - reach; row <= pixel->y + reach; ++row) {
      for (int column = pixel->x - reach; column <= pixel->x + reach; ++column) {
        if (depth_(column, row) == 0) continue;
        const float z = KeyframeGrid::depth_m(depth_(column, row));
        least_m = std::min(least_m, z);
        greatest_m = std::max(greatest_m, z);
        const Eigen::Array3f color = to_channels(color_(column, row));
        low = low.min(color);
        high = high.max(color);
      }
    }
    if (greatest_m == 0) return unseen_before;
    const float tolerance_m = between_cameras.at(point.z());
    if (point.z() > greatest_m + tolerance_m) return always;
    const Eigen::Array3f own = to_channels(now_color_(x, y));
    const bool differs = point.z() < least_m - tolerance_m || (own < low - color_tolerance).any() ||
                         (own > high + color_tolerance).any();
    return differs ? keyframe.stamp_s : since_s_(pixel->x, pixel->y);
  };
  for_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < width; ++x) {
        now_color_(x, y) = keyframe.picture(x * grid_.step(), y * grid_.step());
        now_since_s_(x, y) = since(x, y);
        if (keyframe.stamp_s - now_since_s_(x, y) < stay_s) keyframe.depth(x, y) = 0;
      }
    }
  });
  color_from_world_ = keyframe.color_from_world;
  std::swap(depth_, now_depth_);
  std::swap(color_, now_color_);
  std::swap(since_s_, now_since_s_);
}

}  // namespace diminish
