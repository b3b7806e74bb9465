#include "memory/scene_memory.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/tasks.h"
#include "memory/stands_still.h"

namespace diminish {

SceneMemory::SceneMemory(const Rig& rig)
    : rig_(rig),
      grid_(rig.color),
      users_(rig, grid_, std::nullopt),
      store_(rig, grid_),
      testimonies_(rig.rgbd.size()) {
  for (const RgbdCamera& camera : rig.rgbd) testimony_takers_.emplace_back(camera);
  viewpoints_.reserve(rig.rgbd.size());
  for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
    viewpoints_.push_back({RgbdViewpoint(rig, k), {rig, grid_, k}});
  }
}

void SceneMemory::forget() {
  store_.clear();
  begin_anew();
}

void SceneMemory::begin_anew() {
  pending_ = nullptr;
  store_.forget_before(std::numeric_limits<double>::infinity());
  users_.forget();
  for (Viewpoint& viewpoint : viewpoints_) viewpoint.taker.forget();
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
  for_tasks(testimony_takers_.size(), [&](std::size_t k) {
    testimony_takers_[k].take(inputs.frame.rgbd[k], inputs.poses.depth_from_world[k],
                              inputs.masks.rgbd_depth[k], inputs.masks.rgbd_color[k],
                              testimonies_[k]);
  });
}

bool SceneMemory::has_lost_its_world(const RecallInputs& inputs) {
  look(inputs);
  const auto stood = [&](const Keyframe& keyframe) {
    return !keyframe.testimonies[0].is_given ||
           stands_still(keyframe.testimonies[0], testimonies_[0]);
  };
  return testimonies_[0].is_given && !(pending_ != nullptr && stood(*pending_->pending())) &&
         std::none_of(store_.all().begin(), store_.all().end(),
                      [&](const auto& keyframe) { return stood(*keyframe); });
}

void SceneMemory::leave_places(const RecallInputs& inputs) {
  constexpr double moment_s = 0.5;
  for (auto& [view, taker] : viewpoints_) view.go(inputs);
  store_.forget_if([&](Keyframe& keyframe) {
    if (!keyframe.rgbd) return false;
    const auto& now = viewpoints_[*keyframe.rgbd].view.color_from_world();
    const bool was_current = keyframe.is_current;
    keyframe.is_current = now && !has_moved(keyframe.color_from_world, *now);
    return was_current && !keyframe.is_current &&
           inputs.frame.stamp_s - keyframe.stamp_s > moment_s;
  });
}

std::size_t SceneMemory::recall(const RecallInputs& inputs, bool is_anchored,
                                std::vector<Recollection>& recollections) {
  has_looked_ = false;
  const double now_s = inputs.frame.stamp_s;
  const RigidTransform& color_from_world = *inputs.poses.color_from_world;
  // A recording that begins anew.
  if (now_s < last_stamp_s_) begin_anew();
  users_.follow(color_from_world, now_s);
  last_stamp_s_ = now_s;
  // The last keyframe's steps come one a frame, but within a moment.
  constexpr double moment_s = 0.1;
  do {
    take_step();
  } while (pending_ != nullptr && now_s >= pending_->pending()->stamp_s + moment_s);
  store_.forget_before(now_s - inputs.options.memory_max_age_s);
  if (is_anchored && keyframes() > 0 && has_lost_its_world(inputs)) begin_anew();
  leave_places(inputs);
  if (store_.empty() || inputs.region.empty()) return 0;
  const std::size_t count =
      store_.choose(most_recalled, inputs.masks.color, inputs.region, color_from_world, chosen_);
  if (count == 0) return 0;
  look(inputs);
  while (recollections.size() < count) recollections.emplace_back(rig_, grid_);
  for_tasks(count, [&](std::size_t i) { recollections[i].begin(chosen_[i], inputs); });
  // The frame's pose is wrong by about what the user's own keyframes show.
  const auto own = std::find_if(chosen_.begin(), chosen_.begin() + count,
                                [](const auto& choice) { return choice.keyframe->is_users(); });
  const auto first =
      own == chosen_.begin() + count ? 0 : static_cast<std::size_t>(own - chosen_.begin());
  const std::optional<RigidTransform> motion = recollections[first].align(inputs);
  for_tasks(count, [&](std::size_t i) {
    if (i != first) {
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

KeyframeTaker* SceneMemory::find_due(const RecallInputs& inputs) {
  KeyframeTaker* due = users_.is_due(inputs.objects) ? &users_ : nullptr;
  for (auto& [view, taker] : viewpoints_) {
    if (!view.color_from_world()) continue;
    taker.follow(*view.color_from_world(), inputs.frame.stamp_s);
    if (due == nullptr && !taker.has_jumped() && taker.is_due(inputs.objects)) due = &taker;
  }
  return due;
}

KeyframeView SceneMemory::view_of(const KeyframeTaker& taker, const RecallInputs& inputs,
                                  const SceneSamples& samples) {
  for (auto& [view, own] : viewpoints_) {
    // With the poses as they are refined by now.
    if (&own == &taker && view.go(inputs)) return view.look(inputs, samples);
  }
  return {inputs.poses, inputs.frame.color.view(), inputs.masks.color, inputs.objects, samples,
          inputs.planes};
}

void SceneMemory::learn(const RecallInputs& inputs, const SceneSamples& samples,
                        const std::vector<OccluderReport>& objects,
                        const std::function<void()>& sample) {
  const FrameSet& frame = inputs.frame;
  const bool lost = has_just_lost(objects, frame.stamp_s);
  if (lost || users_.has_jumped() || pending_ != nullptr) return;
  bool sees = !inputs.planes.empty();
  for (std::size_t k = 0; k < frame.rgbd.size(); ++k) {
    sees = sees || (frame.rgbd[k].available() && inputs.poses.depth_from_world[k]);
  }
  if (!sees) return;
  KeyframeTaker* const due = find_due(inputs);
  if (due == nullptr) return;
  if (sample) {
    sample();
    has_looked_ = false;  // at depth that is estimated only now
  }
  if (inputs.is_in_doubt) return;
  look(inputs);
  const bool is_uncertain = std::any_of(objects.begin(), objects.end(),
                                        [](const auto& object) { return !object.message.empty(); });
  due->begin(view_of(*due, inputs, samples), inputs, testimonies_, is_uncertain, store_.take());
  pending_ = due;
}

const std::vector<std::shared_ptr<Keyframe>>& SceneMemory::all() {
  while (pending_ != nullptr) take_step();
  return store_.all();
}

void SceneMemory::take_step() {
  if (pending_ == nullptr) return;
  if (auto keyframe = pending_->take_step()) {
    pending_ = nullptr;
    store_.add(std::move(keyframe));
  }
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
