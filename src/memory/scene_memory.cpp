#include "memory/scene_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/rows.h"
#include "core/tasks.h"
#include "memory/stands_still.h"

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
  store_.clear();
  begin_anew();
}

void SceneMemory::begin_anew() {
  pending_.steps = 0;
  store_.forget_before(std::numeric_limits<double>::infinity());
  depth_.forget();
  novelty_.forget();
  last_keyframe_from_world_.reset();
  last_from_world_.reset();
}

void SceneMemory::set_background(std::vector<Keyframe> keyframes) {
  forget();
  for (Keyframe& keyframe : keyframes) {
    store_.add(std::make_shared<Keyframe>(std::move(keyframe)));
  }
}

void SceneMemory::look(const RecallInputs& inputs) {
  if (has_looked_) return;
  has_looked_ = true;
  for_tasks(takers_.size(), [&](std::size_t k) {
    takers_[k].take(inputs.frame.rgbd[k], inputs.poses.depth_from_world[k],
                    inputs.masks.rgbd_depth[k], inputs.masks.rgbd_color[k], testimonies_[k]);
  });
}

bool SceneMemory::has_jumped(const RigidTransform& color_from_world, double elapsed_s) const {
  if (!last_from_world_) return false;
  constexpr double reach_m = 0.05;
  constexpr double fastest_m_per_s = 3;
  constexpr double reach_deg = 5;
  constexpr double fastest_deg_per_s = 300;
  const RigidTransform motion = color_from_world * last_from_world_->inverse();
  return motion.translation.norm() > reach_m + fastest_m_per_s * elapsed_s ||
         rotation_difference_deg(motion.rotation, Eigen::Matrix3d::Identity()) >
             reach_deg + fastest_deg_per_s * elapsed_s;
}

bool SceneMemory::has_lost_its_world(const RecallInputs& inputs) {
  look(inputs);
  const auto stood = [&](const Keyframe& keyframe) {
    return !keyframe.testimonies[0].is_given ||
           stands_still(keyframe.testimonies[0], testimonies_[0]);
  };
  return testimonies_[0].is_given && !(pending_.steps > 0 && stood(*pending_.keyframe)) &&
         std::none_of(store_.all().begin(), store_.all().end(),
                      [&](const auto& keyframe) { return stood(*keyframe); });
}

std::size_t SceneMemory::recall(const RecallInputs& inputs, bool is_anchored,
                                std::vector<Recollection>& recollections) {
  has_looked_ = false;
  const double now_s = inputs.frame.stamp_s;
  const RigidTransform& color_from_world = *inputs.poses.color_from_world;
  // A recording that begins anew.
  if (now_s < last_stamp_s_) begin_anew();
  has_jumped_ = has_jumped(color_from_world, now_s - last_stamp_s_);
  last_stamp_s_ = now_s;
  last_from_world_ = color_from_world;
  // The last keyframe's steps come one a frame, but within a moment.
  constexpr double moment_s = 0.1;
  do {
    take_step();
  } while (pending_.steps > 0 && now_s >= pending_.keyframe->stamp_s + moment_s);
  store_.forget_before(now_s - inputs.options.memory_max_age_s);
  if (is_anchored && keyframes() > 0 && has_lost_its_world(inputs)) begin_anew();
  if (store_.empty() || inputs.region.empty()) return 0;
  const std::size_t count =
      store_.choose(most_recalled, inputs.masks.color, inputs.region, color_from_world, chosen_);
  if (count == 0) return 0;
  look(inputs);
  while (recollections.size() < count) recollections.emplace_back(rig_, grid_);
  for_tasks(count, [&](std::size_t i) { recollections[i].begin(chosen_[i], inputs); });
  const std::optional<RigidTransform> motion = recollections[0].align(inputs);
  for_tasks(count, [&](std::size_t i) {
    if (i > 0) {
      recollections[i].move(motion);
      recollections[i].align(inputs);  // its own pose is wrong, too
    }
    recollections[i].prepare(inputs, testimonies_);
  });
  for (std::size_t i = 0; i < count; ++i) {
    store_.remove(recollections[i].gone(), chosen_[i].keyframe->color_from_world);
    const Witness& witness = recollections[i].witness();
    store_.refresh(*chosen_[i].keyframe, witness.confirmed(), witness.part(), now_s);
  }
  return count;
}

bool SceneMemory::is_worth_a_keyframe(const RecallInputs& inputs) const {
  if (pending_.steps > 0) return false;
  if (!last_keyframe_from_world_) return true;
  constexpr double shortest_s = 0.2;
  constexpr double longest_s = 2;
  constexpr int moved_share = 16;  // of the objects' size: 1 / 16
  constexpr double moved_m = 0.04;
  constexpr double turned_deg = 2;
  const double since_s = inputs.frame.stamp_s - last_keyframe_s_;
  if (since_s < shortest_s) return false;
  if (since_s >= longest_s) return true;
  const RigidTransform motion =
      *inputs.poses.color_from_world * last_keyframe_from_world_->inverse();
  const Rect& objects = inputs.objects;
  const int objects_moved =
      std::max({std::abs(objects.x - last_objects_.x), std::abs(objects.y - last_objects_.y),
                std::abs(objects.right() - last_objects_.right()),
                std::abs(objects.bottom() - last_objects_.bottom())});
  const int size = std::max(objects.width, objects.height);
  return moved_share * objects_moved > size || motion.translation.norm() > moved_m ||
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
  const int margin = object_margin_px(step);
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
                        const std::vector<OccluderReport>& objects,
                        const std::function<void()>& sample) {
  const FrameSet& frame = inputs.frame;
  const bool lost = has_just_lost(objects, frame.stamp_s);
  if (lost || has_jumped_ || !is_worth_a_keyframe(inputs)) return;
  bool sees = !inputs.planes.empty();
  for (std::size_t k = 0; k < frame.rgbd.size(); ++k) {
    sees = sees || (frame.rgbd[k].available() && inputs.poses.depth_from_world[k]);
  }
  if (!sees) return;
  if (sample) {
    sample();
    has_looked_ = false;  // at depth that is estimated only now
  }
  if (inputs.is_in_doubt) return;
  look(inputs);
  last_keyframe_s_ = frame.stamp_s;
  last_keyframe_from_world_ = inputs.poses.color_from_world;
  last_objects_ = inputs.objects;
  pending_.keyframe = store_.take();
  Keyframe& keyframe = *pending_.keyframe;
  keyframe.is_background = false;
  keyframe.stamp_s = frame.stamp_s;
  keyframe.color_from_world = *inputs.poses.color_from_world;
  keyframe.color_from_depth = inputs.poses.color_from_depth;
  keyframe.testimonies = testimonies_;
  copy(frame.color.view(), keyframe.picture);
  pending_.objects = inputs.masks.color;
  pending_.is_uncertain = std::any_of(objects.begin(), objects.end(),
                                      [](const auto& object) { return !object.message.empty(); });
  depth_.draw(frame, inputs.poses, inputs.masks, samples, inputs.planes, inputs.options);
  pending_.steps = 2;
}

const std::vector<std::shared_ptr<Keyframe>>& SceneMemory::all() {
  while (pending_.steps > 0) take_step();
  return store_.all();
}

void SceneMemory::take_step() {
  if (pending_.steps == 0) return;
  Keyframe& keyframe = *pending_.keyframe;
  if (--pending_.steps > 0) return depth_.complete(pending_.objects, keyframe);
  leave_out_objects(keyframe);
  novelty_.filter(pending_.is_uncertain, keyframe);
  store_.add(std::exchange(pending_.keyframe, nullptr));
}

void anchor(const Poses& poses, Poses& result) {
  result.color_from_world = poses.color_from_world;
  result.depth_from_world = poses.depth_from_world;
  result.color_from_depth = poses.color_from_depth;
  result.messages.clear();
  if (result.color_from_world || result.color_from_depth.empty()) return;
  const auto& first = result.color_from_depth.front();
  if (!first) return;
  result.color_from_world = first;
  for (std::size_t k = 0; k < result.color_from_depth.size(); ++k) {
    const auto& color_from_depth = result.color_from_depth[k];
    result.depth_from_world[k].reset();
    if (color_from_depth) result.depth_from_world[k] = color_from_depth->inverse() * *first;
  }
}

}  // namespace diminish
