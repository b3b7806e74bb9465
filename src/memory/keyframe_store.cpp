#include "memory/keyframe_store.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "core/tasks.h"
#include "geometry/point_rows.h"

namespace diminish {
namespace {

/// The side of a cell: the distance of the overview's points.
int cell_px(const KeyframeGrid& grid) {
  return KeyframeGrid::overview_step * grid.step();
}
/// Forgets the other places. Returns whether any is left.
bool keep_confirmed_since(double stamp_s, Keyframe& keyframe) {
  constexpr int step = KeyframeGrid::overview_step;
  const auto least_s = static_cast<float>(stamp_s - keyframe.stamp_s);
  bool any = false;
  for (int y = 0; y < keyframe.depth.height(); ++y) {
    std::uint16_t* const depth = keyframe.depth.row(y);
    const float* const confirmed_s = keyframe.confirmed_s.row(y);
    std::uint16_t in_row = 0;
    for (int x = 0; x < keyframe.depth.width(); ++x) {
      depth[x] = confirmed_s[x] >= least_s ? depth[x] : std::uint16_t{0};
      in_row = static_cast<std::uint16_t>(in_row | depth[x]);
    }
    any = any || in_row != 0;
    if (y % step != 0) continue;
    float* const overview_m = keyframe.overview_m.row(y / step);
    for (int x = 0; x < keyframe.overview_m.width(); ++x) {
      if (keyframe.depth(x * step, y) == 0) overview_m[x] = 0;
    }
  }
  return any;
}
/// How many there are in a region.
Rect cells_of(const Rect& region, int cell) {
  return {0, 0, (region.width - 1) / cell + 1, (region.height - 1) / cell + 1};
}

}  // namespace

KeyframeStore::KeyframeStore(const Rig& rig, const KeyframeGrid& grid)
    : grid_(grid),
      preparation_(rig, grid),
      color_(Lens(rig.color)),
      picture_width_(rig.color.width) {}

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
        const auto pixel = project(grid_.lens(), there);
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

void KeyframeStore::let_go(std::shared_ptr<Keyframe> keyframe) {
  constexpr std::size_t most = 4;
  if (gone_.size() < most) gone_.push_back(std::move(keyframe));
}

void KeyframeStore::clear() {
  keyframes_.clear();
  gone_.clear();
}

std::shared_ptr<Keyframe> KeyframeStore::take() {
  const auto unused = std::find_if(gone_.begin(), gone_.end(),
                                   [](const auto& keyframe) { return keyframe.use_count() == 1; });
  if (unused == gone_.end()) return std::make_shared<Keyframe>();
  // After whoever looked at it last.
  std::atomic_thread_fence(std::memory_order_acquire);
  std::shared_ptr<Keyframe> keyframe = std::move(*unused);
  gone_.erase(unused);
  return keyframe;
}

void KeyframeStore::add(std::shared_ptr<Keyframe> keyframe) {
  preparation_.prepare(*keyframe);
  keyframes_.push_back(std::move(keyframe));
  const std::size_t affordable = most_bytes / std::max<std::size_t>(1, newest().bytes());
  if (size() <= std::clamp<std::size_t>(affordable, 2, most_keyframes)) return;
  std::vector<std::size_t> unique(size());
  for_tasks(size() - 1, [&](std::size_t i) { unique[i] = count_unique(i); });
  const auto least =
      keyframes_.begin() + (std::min_element(unique.begin(), unique.end() - 1) - unique.begin());
  let_go(std::move(*least));
  keyframes_.erase(least);
}

std::size_t KeyframeStore::bytes() const {
  return std::accumulate(
      keyframes_.begin(), keyframes_.end(), std::size_t{0},
      [](std::size_t sum, const auto& keyframe) { return sum + keyframe->bytes(); });
}

void KeyframeStore::forget_before(double stamp_s) {
  forget_if([&](Keyframe& keyframe) {
    return !keyframe.is_background && keyframe.stamp_s < stamp_s &&
           !keep_confirmed_since(stamp_s, keyframe);
  });
}

void KeyframeStore::refresh(const Keyframe& keyframe, const Mask& confirmed, const Rect& part,
                            double stamp_s) {
  const auto kept = std::find_if(keyframes_.begin(), keyframes_.end(), [&](const auto& candidate) {
    return candidate.get() == &keyframe;
  });
  if (kept == keyframes_.end()) return;
  const auto since_s = static_cast<float>(stamp_s - keyframe.stamp_s);
  for (int y = part.y; y < part.bottom(); ++y) {
    const std::uint8_t* const is_confirmed = confirmed.row(y) + part.x;
    float* const confirmed_s = (*kept)->confirmed_s.row(y) + part.x;
    for (int x = 0; x < part.width; ++x) {
      const float before_s = confirmed_s[x];
      confirmed_s[x] = is_confirmed[x] != 0 ? since_s : before_s;
    }
  }
}

void KeyframeStore::find_shown(const Keyframe& keyframe, const RigidTransform& color_from_keyframe,
                               const Rect& region, std::vector<std::uint8_t>& shown) const {
  const int cell = cell_px(grid_);
  const Rect cells = cells_of(region, cell);
  const RayTable& rays = grid_.overview_rays();
  const PointView view{FloatTransform(color_from_keyframe), color_, region, picture_width_};
  std::int32_t pixels[KeyframeGrid::most_columns];
  float unused[KeyframeGrid::most_columns];
  shown.assign(static_cast<std::size_t>(cells.width) * static_cast<std::size_t>(cells.height), 0);
  for (int y = 0; y < rays.height(); ++y) {
    find_pixels({rays.x(y), rays.y(y), keyframe.overview_m.row(y), rays.width()}, view, pixels,
                unused);
    for (int x = 0; x < rays.width(); ++x) {
      if (pixels[x] < 0) continue;
      const int row = pixels[x] / picture_width_;
      const int column = pixels[x] - row * picture_width_;
      const int i = (row - region.y) / cell * cells.width + (column - region.x) / cell;
      shown[static_cast<std::size_t>(i)] = 1;
    }
  }
}

void KeyframeStore::find_part(const std::vector<std::uint8_t>& shown, const Rect& region,
                              TiledRegion& part) const {
  const int cell = cell_px(grid_);
  const Rect cells = cells_of(region, cell);
  const auto cells_in = [&](const Rect& pixels) {
    const int left = std::max(0, pixels.x - region.x) / cell;
    const int top = std::max(0, pixels.y - region.y) / cell;
    return intersect({left, top, (pixels.right() - region.x - 1) / cell + 1 - left,
                      (pixels.bottom() - region.y - 1) / cell + 1 - top},
                     cells);
  };
  const auto shows = [&](const Rect& among) {
    for (int y = among.y; y < among.bottom(); ++y) {
      for (int x = among.x; x < among.right(); ++x) {
        const int cell_index = y * cells.width + x;
        const auto i = static_cast<std::size_t>(cell_index);
        if (shown[i] != 0 && hidden_[i] != 0) return true;
      }
    }
    return false;
  };
  Rect box;
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x) {
      if (!shows({x, y, 1, 1})) continue;
      box = join(box, {region.x + x * cell, region.y + y * cell, cell, cell});
    }
  }
  // A cell more, as poses are not aligned yet.
  part.set(intersect(grow(box, cell), region));
  part.keep_if([&](const Rect& tile) { return shows(cells_in(grow(tile, cell))); });
}

std::size_t KeyframeStore::choose(std::size_t most, const Mask& objects, const TiledRegion& region,
                                  const RigidTransform& color_from_world,
                                  std::vector<Choice>& chosen) {
  constexpr int least_pixels = 256;
  constexpr int least_share = 64;  // of the objects: 1 / 64
  constexpr int sampled_rows = 2;
  constexpr double near_m = 0.05;
  const int cell = cell_px(grid_);
  const Rect cells = cells_of(region, cell);
  hidden_.assign(static_cast<std::size_t>(cells.width) * static_cast<std::size_t>(cells.height), 0);
  int all = 0;
  for (int y = region.y; y < region.bottom(); y += sampled_rows) {
    const int row = (y - region.y) / cell;
    int* const hidden = hidden_.data() + std::ptrdiff_t{row} * cells.width;
    const std::uint8_t* const masked = objects.row(y) + region.x;
    for (int i = 0; i < cells.width; ++i) {
      const int last = std::min(region.width, (i + 1) * cell);
      int pixels = 0;
      for (int x = i * cell; x < last; ++x) pixels += masked[x] != 0 ? sampled_rows : 0;
      hidden[i] += pixels;
      all += pixels;
    }
  }
  wanted_ = hidden_;
  const int fewest = std::max(least_pixels, all / least_share);
  shown_.resize(size());
  weights_.resize(size());
  for_tasks(size(), [&](std::size_t k) {
    weights_[k] = 0;
    if (keyframes_[k]->is_current) return;
    const RigidTransform motion = color_from_world * keyframes_[k]->color_from_world.inverse();
    weights_[k] = 1 / (1 + motion.translation.norm() / near_m);
    find_shown(*keyframes_[k], motion, region, shown_[k]);
  });
  std::size_t count_chosen = 0;
  while (count_chosen < most) {
    std::size_t best = size();
    double best_value = 0;
    for (std::size_t k = size(); k-- > 0;) {
      if (weights_[k] == 0) continue;
      int count = 0;
      for (std::size_t i = 0; i < wanted_.size(); ++i) count += shown_[k][i] * wanted_[i];
      const double value = count < fewest ? 0 : weights_[k] * count;
      if (!(value > best_value)) continue;
      best_value = value;
      best = k;
    }
    if (best == size()) break;
    if (chosen.size() == count_chosen) chosen.emplace_back();
    chosen[count_chosen].keyframe = keyframes_[best];
    find_part(shown_[best], region, chosen[count_chosen++].part);
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      if (shown_[best][i] != 0) wanted_[i] = 0;
    }
  }
  return count_chosen;
}

void KeyframeStore::remove(const std::vector<Eigen::Vector3f>& points_m,
                           const RigidTransform& color_from_world) {
  if (points_m.empty()) return;
  for_tasks(size(), [&](std::size_t i) {
    Keyframe& keyframe = *keyframes_[i];
    const FloatTransform to_keyframe(keyframe.color_from_world * color_from_world.inverse());
    for (const Eigen::Vector3f& x_in_other : points_m) {
      const Eigen::Vector3f point = transform(to_keyframe, x_in_other);
      const auto pixel = project(grid_.lens(), point);
      if (!pixel) continue;
      const Rect around = intersect(grow({pixel->x, pixel->y, 1, 1}, 1), keyframe.depth.bounds());
      for (int y = around.y; y < around.bottom(); ++y) {
        for (int x = around.x; x < around.right(); ++x) {
          std::uint16_t& depth = keyframe.depth(x, y);
          if (std::abs(KeyframeGrid::depth_m(depth) - point.z()) >= between_cameras.at(point.z())) {
            continue;
          }
          depth = 0;
          constexpr int step = KeyframeGrid::overview_step;
          if (x % step == 0 && y % step == 0) keyframe.overview_m(x / step, y / step) = 0;
        }
      }
    }
  });
}

}  // namespace diminish
