#include "memory/scene_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rows.h"
#include "core/tasks.h"

namespace diminish {

SceneMemory::SceneMemory(const Rig& rig)
    : rig_(rig),
      grid_(rig.color),
      depth_(rig, grid_),
      novelty_(grid_),
      store_(rig, grid_),
      testimonies_(rig.rgbd.size()) {
  for (const RgbdCamera& camera : rig.rgbd) takers_.emplace_back(camera);
}

void SceneMemory::forget() {
  pending_.steps = 0;
  store_.clear();
  depth_.forget();
  novelty_.forget();
}

void SceneMemory::look(const RecallInputs& inputs) {
  if (has_looked_) return;
  has_looked_ = true;
  for_tasks(takers_.size(), [&](std::size_t k) {
    takers_[k].take(inputs.frame.rgbd[k], inputs.poses.depth_from_world[k],
                    inputs.masks.rgbd_depth[k], inputs.masks.rgbd_color[k], testimonies_[k]);
  });
}

std::size_t SceneMemory::recall(const RecallInputs& inputs,
                                std::vector<Recollection>& recollections) {
  has_looked_ = false;
  const double now_s = inputs.frame.stamp_s;
  // A recording that begins anew.
  if (now_s < last_stamp_s_) forget();
  last_stamp_s_ = now_s;
  // The last keyframe's steps come one a frame, but within a moment.
  constexpr double moment_s = 0.1;
  do {
    take_step();
  } while (now_s >= pending_.keyframe.stamp_s + moment_s && pending_.steps > 0);
  store_.drop_older_than(now_s - inputs.options.memory_max_age_s);
  if (store_.empty() || inputs.region.empty()) return 0;
  const RigidTransform& color_from_world = *inputs.poses.color_from_world;
  store_.choose(most_recalled, inputs.masks.color, inputs.region, color_from_world, chosen_);
  if (chosen_.empty()) return 0;
  look(inputs);
  while (recollections.size() < chosen_.size()) recollections.emplace_back(rig_, grid_);
  for_tasks(chosen_.size(),
            [&](std::size_t i) { recollections[i].prepare(chosen_[i], inputs, testimonies_); });
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    store_.remove(recollections[i].gone(), chosen_[i]->color_from_world);
  }
  return chosen_.size();
}

bool SceneMemory::is_worth_a_keyframe(const RecallInputs& inputs) const {
  if (pending_.steps > 0) return false;
  if (store_.empty()) return true;
  constexpr double shortest_s = 0.2;
  constexpr double longest_s = 2;
  constexpr int moved_px = 8;
  constexpr double moved_m = 0.01;
  constexpr double turned_deg = 0.5;
  const double since_s = inputs.frame.stamp_s - last_keyframe_s_;
  if (since_s < shortest_s) return false;
  if (since_s >= longest_s) return true;
  const RigidTransform motion =
      *inputs.poses.color_from_world * store_.newest().color_from_world.inverse();
  const Rect& objects = inputs.objects;
  const int objects_moved =
      std::max({std::abs(objects.x - last_objects_.x), std::abs(objects.y - last_objects_.y),
                std::abs(objects.right() - last_objects_.right()),
                std::abs(objects.bottom() - last_objects_.bottom())});
  return objects_moved > moved_px || motion.translation.norm() > moved_m ||
         rotation_difference_deg(motion.rotation, Eigen::Matrix3d::Identity()) > turned_deg;
}

bool SceneMemory::has_just_lost(const std::vector<OccluderReport>& objects, double stamp_s) {
  constexpr double moment_s = 2;
  found_s_.resize(objects.size(), -std::numeric_limits<double>::infinity());
  bool lost = false;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].message.empty()) found_s_[i] = stamp_s;
    lost = lost || (found_s_[i] < stamp_s && stamp_s - found_s_[i] < moment_s);
  }
  return lost;
}

void SceneMemory::leave_out_objects(Keyframe& keyframe) {
  const Mask& objects = pending_.objects;
  const int step = grid_.step();
  // A cell of the grid, and what their edges shine onto.
  const int margin = step + 6;
  const Rect part = grow(last_objects_, margin);
  object_columns_.resize(static_cast<std::size_t>(objects.width()));
  for (int y = 0; y < keyframe.depth.height(); ++y) {
    const Rect band = intersect({0, y * step - margin, objects.width(), 2 * margin + 1},
                                intersect(part, objects.bounds()));
    if (band.empty()) continue;
    std::uint8_t* const columns = object_columns_.data();
    std::fill_n(columns + band.x, band.width, std::uint8_t{0});
    for (int row = band.y; row < band.bottom(); ++row) {
      const std::uint8_t* const masked = objects.row(row);
      for (int x = band.x; x < band.right(); ++x) columns[x] |= masked[x];
    }
    for (int x = 0; x < keyframe.depth.width(); ++x) {
      const int first = std::max(band.x, x * step - margin);
      const int last = std::min(band.right(), x * step + margin + 1);
      if (std::any_of(columns + first, columns + std::max(first, last),
                      [](std::uint8_t any) { return any != 0; })) {
        keyframe.depth(x, y) = 0;
      }
    }
  }
}

void SceneMemory::learn(const RecallInputs& inputs, const SceneSamples& samples,
                        const std::vector<OccluderReport>& objects) {
  const FrameSet& frame = inputs.frame;
  const bool lost = has_just_lost(objects, frame.stamp_s);
  if (lost || !is_worth_a_keyframe(inputs)) return;
  look(inputs);
  const bool sees = std::any_of(testimonies_.begin(), testimonies_.end(),
                                [](const Testimony& testimony) { return testimony.is_given; });
  if (!sees) return;
  last_keyframe_s_ = frame.stamp_s;
  last_objects_ = inputs.objects;
  Keyframe& keyframe = pending_.keyframe;
  keyframe = {};
  keyframe.stamp_s = frame.stamp_s;
  keyframe.color_from_world = *inputs.poses.color_from_world;
  keyframe.color_from_depth = inputs.poses.color_from_depth;
  keyframe.testimonies = testimonies_;
  copy(frame.color.view(), keyframe.picture);
  pending_.objects = inputs.masks.color;
  pending_.is_uncertain = std::any_of(objects.begin(), objects.end(),
                                      [](const auto& object) { return !object.message.empty(); });
  depth_.draw(frame, inputs.poses, inputs.masks, samples, inputs.options);
  pending_.steps = 2;
}

void SceneMemory::take_step() {
  if (pending_.steps == 0) return;
  Keyframe& keyframe = pending_.keyframe;
  if (--pending_.steps > 0) return depth_.complete(pending_.objects, keyframe);
  leave_out_objects(keyframe);
  novelty_.filter(pending_.is_uncertain, keyframe);
  store_.add(std::move(keyframe));
}

Poses anchored(const Poses& poses) {
  Poses result = poses;
  result.messages.clear();
  if (result.color_from_world || result.color_from_depth.empty()) return result;
  const auto& first = result.color_from_depth.front();
  if (!first) return result;
  result.color_from_world = first;
  for (std::size_t k = 0; k < result.color_from_depth.size(); ++k) {
    const auto& color_from_depth = result.color_from_depth[k];
    result.depth_from_world[k].reset();
    if (color_from_depth) result.depth_from_world[k] = color_from_depth->inverse() * *first;
  }
  return result;
}

}  // namespace diminish
