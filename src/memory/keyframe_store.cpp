#include "memory/keyframe_store.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/tasks.h"

namespace diminish {
KeyframeStore::KeyframeStore(const Intrinsics& color, const KeyframeGrid& grid)
    : grid_(grid), color_(Lens(color)), lens_(Lens(grid.intrinsics())) {}

std::size_t KeyframeStore::count_unique(std::size_t index) const {
  constexpr int stride = 8;
  const Keyframe& own = *keyframes_[index];
  std::vector<FloatTransform> to_others;
  for (const auto& other : keyframes_) {
    to_others.emplace_back(other->color_from_world * own.color_from_world.inverse());
  }
  std::size_t count = 0;
  for (int y = 0; y < own.depth.height(); y += stride) {
    for (int x = 0; x < own.depth.width(); x += stride) {
      if (own.depth(x, y) == 0) continue;
      const Eigen::Vector3f point = grid_.point_m(x, y, own.depth(x, y));
      bool is_elsewhere = false;
      for (std::size_t i = 0; i < keyframes_.size() && !is_elsewhere; ++i) {
        if (i == index) continue;
        const Eigen::Vector3f there = transform(to_others[i], point);
        const auto pixel = project(lens_, there);
        const Image<std::uint16_t>& depth = keyframes_[i]->depth;
        is_elsewhere = pixel && depth.bounds().contains(pixel->x, pixel->y) &&
                       std::abs(KeyframeGrid::depth_m(depth(pixel->x, pixel->y)) - there.z()) <
                           between_cameras.at(there.z());
      }
      count += is_elsewhere ? 0 : 1;
    }
  }
  return count;
}

void KeyframeStore::add(Keyframe keyframe) {
  keyframes_.push_back(std::make_shared<Keyframe>(std::move(keyframe)));
  const std::size_t affordable = most_bytes / std::max<std::size_t>(1, newest().bytes());
  if (size() <= std::clamp<std::size_t>(affordable, 2, most_keyframes)) return;
  std::vector<std::size_t> unique(size());
  for_tasks(size() - 1, [&](std::size_t i) { unique[i] = count_unique(i); });
  keyframes_.erase(keyframes_.begin() +
                   (std::min_element(unique.begin(), unique.end() - 1) - unique.begin()));
}

std::size_t KeyframeStore::bytes() const {
  return std::accumulate(
      keyframes_.begin(), keyframes_.end(), std::size_t{0},
      [](std::size_t sum, const auto& keyframe) { return sum + keyframe->bytes(); });
}

void KeyframeStore::drop_older_than(double stamp_s) {
  std::erase_if(keyframes_, [&](const auto& keyframe) { return keyframe->stamp_s < stamp_s; });
}

std::vector<std::shared_ptr<const Keyframe>> KeyframeStore::choose(
    std::size_t most, const Mask& objects, const TiledRegion& region,
    const RigidTransform& color_from_world) const {
  constexpr int cell = 8;    // pixels
  constexpr int stride = 4;  // places of the grid
  constexpr int fewest = 4;  // cells
  constexpr double near_m = 0.05;
  const int columns = region.width / cell + 1;
  const int rows = region.height / cell + 1;
  using Cells = std::vector<std::uint8_t>;
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>((y - region.y) / cell) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>((x - region.x) / cell);
  };
  Cells wanted(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int y = region.y; y < region.bottom(); ++y) {
    for (int x = region.x; x < region.right(); ++x) {
      if (objects(x, y) != 0) wanted[index(x, y)] = 1;
    }
  }
  std::vector<Cells> covered(size());
  std::vector<double> weights(size());
  for_tasks(size(), [&](std::size_t k) {
    const Keyframe& keyframe = *keyframes_[k];
    const RigidTransform motion = color_from_world * keyframe.color_from_world.inverse();
    const FloatTransform to_color(motion);
    weights[k] = 1 / (1 + motion.translation.norm() / near_m);
    covered[k].assign(wanted.size(), 0);
    for (int y = 0; y < keyframe.depth.height(); y += stride) {
      for (int x = 0; x < keyframe.depth.width(); x += stride) {
        if (keyframe.depth(x, y) == 0) continue;
        const auto pixel =
            project(color_, transform(to_color, grid_.point_m(x, y, keyframe.depth(x, y))));
        if (pixel && region.contains(pixel->x, pixel->y)) covered[k][index(pixel->x, pixel->y)] = 1;
      }
    }
  });
  std::vector<std::shared_ptr<const Keyframe>> chosen;
  while (chosen.size() < most) {
    std::size_t best = size();
    double best_value = 0;
    for (std::size_t k = size(); k-- > 0;) {
      int count = 0;
      for (std::size_t i = 0; i < wanted.size(); ++i) count += wanted[i] & covered[k][i];
      const double value = count < fewest ? 0 : weights[k] * count;
      if (!(value > best_value)) continue;
      best_value = value;
      best = k;
    }
    if (best == size()) break;
    chosen.push_back(keyframes_[best]);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (covered[best][i] != 0) wanted[i] = 0;
    }
  }
  return chosen;
}

void KeyframeStore::remove(const std::vector<Eigen::Vector3f>& points_m,
                           const RigidTransform& color_from_world) {
  if (points_m.empty()) return;
  for_tasks(size(), [&](std::size_t i) {
    Keyframe& keyframe = *keyframes_[i];
    const FloatTransform to_keyframe(keyframe.color_from_world * color_from_world.inverse());
    for (const Eigen::Vector3f& x_in_other : points_m) {
      const Eigen::Vector3f point = transform(to_keyframe, x_in_other);
      const auto pixel = project(lens_, point);
      if (!pixel) continue;
      const Rect around = intersect(grow({pixel->x, pixel->y, 1, 1}, 1), keyframe.depth.bounds());
      for (int y = around.y; y < around.bottom(); ++y) {
        for (int x = around.x; x < around.right(); ++x) {
          std::uint16_t& depth = keyframe.depth(x, y);
          if (std::abs(KeyframeGrid::depth_m(depth) - point.z()) < between_cameras.at(point.z()))
            depth = 0;
        }
      }
    }
  });
}

}  // namespace diminish
