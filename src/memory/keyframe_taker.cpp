#include "memory/keyframe_taker.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace diminish {

namespace {

/// Whether a camera has moved by more than a distance or an angle.
bool has_moved_by(double moved_m, double turned_deg, const RigidTransform& before_from_world,
                  const RigidTransform& now_from_world) {
  const RigidTransform motion = now_from_world * before_from_world.inverse();
  return motion.translation.norm() > moved_m ||
         rotation_difference_deg(motion.rotation, Eigen::Matrix3d::Identity()) > turned_deg;
}

}  // namespace

bool has_moved(const RigidTransform& before_from_world, const RigidTransform& now_from_world,
               double reach) {
  constexpr double moved_m = 0.02;
  constexpr double turned_deg = 1;
  return has_moved_by(reach * moved_m, reach * turned_deg, before_from_world, now_from_world);
}

KeyframeTaker::KeyframeTaker(const Rig& rig, const KeyframeGrid& grid,
                             std::optional<std::size_t> rgbd)
    : rgbd_(rgbd), grid_(grid), depth_(rig, grid, !rgbd), novelty_(grid) {}

void KeyframeTaker::forget() {
  keyframe_.reset();
  depth_.forget();
  novelty_.forget();
  last_keyframe_from_world_.reset();
  first_from_world_.reset();
  last_from_world_.reset();
}

void KeyframeTaker::follow(const RigidTransform& color_from_world, double stamp_s) {
  constexpr double reach_m = 0.05;
  constexpr double fastest_m_per_s = 3;
  constexpr double reach_deg = 5;
  constexpr double fastest_deg_per_s = 300;
  const double elapsed_s = stamp_s - last_stamp_s_;
  has_jumped_ = last_from_world_ && has_moved_by(reach_m + fastest_m_per_s * elapsed_s,
                                                 reach_deg + fastest_deg_per_s * elapsed_s,
                                                 *last_from_world_, color_from_world);
  last_stamp_s_ = stamp_s;
  last_from_world_ = color_from_world;
  if (!first_from_world_) first_from_world_ = color_from_world;
}

bool KeyframeTaker::is_due(const Rect& object_box) const {
  constexpr double shortest_s = 0.2;
  constexpr double longest_s = 2;
  constexpr int moved_share = 16;  // of the objects' size: 1 / 16
  if (!last_keyframe_from_world_) {
    return !rgbd_ || has_moved(*first_from_world_, *last_from_world_);
  }
  const double since_s = last_stamp_s_ - last_keyframe_s_;
  if (since_s < shortest_s) return false;
  constexpr double users_reach = 2;
  const double reach = rgbd_ ? 1 : users_reach;
  if (has_moved(*last_keyframe_from_world_, *last_from_world_, reach)) return true;
  if (rgbd_) return false;
  const int objects_moved =
      std::max({std::abs(object_box.x - last_objects_.x), std::abs(object_box.y - last_objects_.y),
                std::abs(object_box.right() - last_objects_.right()),
                std::abs(object_box.bottom() - last_objects_.bottom())});
  return since_s >= longest_s ||
         moved_share * objects_moved > std::max(object_box.width, object_box.height);
}

void KeyframeTaker::begin(const KeyframeView& view, const RecallInputs& inputs,
                          const std::vector<Testimony>& testimonies, bool is_uncertain,
                          std::shared_ptr<Keyframe> keyframe) {
  last_keyframe_s_ = inputs.frame.stamp_s;
  last_keyframe_from_world_ = view.poses.color_from_world;
  last_objects_ = view.object_box;
  keyframe->is_background = false;
  keyframe->rgbd = rgbd_;
  keyframe->is_current = rgbd_.has_value();
  keyframe->stamp_s = inputs.frame.stamp_s;
  keyframe->color_from_world = *view.poses.color_from_world;
  keyframe->color_from_depth = view.poses.color_from_depth;
  keyframe->testimonies = testimonies;
  copy(view.picture, keyframe->picture);
  keyframe_ = std::move(keyframe);
  objects_ = view.objects;
  is_uncertain_ = is_uncertain;
  depth_.draw(inputs.frame, view.poses, inputs.masks, view.samples, view.planes, inputs.options);
  steps_ = 2;
}

std::shared_ptr<Keyframe> KeyframeTaker::take_step() {
  if (--steps_ > 0) {
    depth_.complete(objects_, *keyframe_);
    return nullptr;
  }
  leave_out_objects();
  novelty_.filter(is_uncertain_, *keyframe_);
  return std::exchange(keyframe_, nullptr);
}

void KeyframeTaker::leave_out_objects() {
  Image<std::uint16_t>& depth = keyframe_->depth;
  const int step = grid_.step();
  const int margin = object_margin_px(step);
  const Rect part = grow(last_objects_, margin);
  object_columns_.resize(static_cast<std::size_t>(objects_.width()));
  for (int y = 0; y < depth.height(); ++y) {
    const Rect band = intersect({0, y * step - margin, objects_.width(), 2 * margin + 1},
                                intersect(part, objects_.bounds()));
    if (band.empty()) continue;
    std::uint8_t* const columns = object_columns_.data();
    std::fill_n(columns + band.x, band.width, std::uint8_t{0});
    for (int row = band.y; row < band.bottom(); ++row) {
      const std::uint8_t* const masked = objects_.row(row);
      for (int x = band.x; x < band.right(); ++x) columns[x] |= masked[x];
    }
    for (int x = 0; x < depth.width(); ++x) {
      const int first = std::max(band.x, x * step - margin);
      const int last = std::min(band.right(), x * step + margin + 1);
      if (std::any_of(columns + first, columns + std::max(first, last),
                      [](std::uint8_t any) { return any != 0; })) {
        depth(x, y) = 0;
      }
    }
  }
}

}  // namespace diminish
