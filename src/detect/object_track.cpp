#include "detect/object_track.h"

#include <algorithm>

namespace diminish {

void ObjectTrack::add(double stamp_s, bool is_world, const RigidTransform& frame_from_object) {
  if (is_world != is_world_ || (!moments_.empty() && stamp_s <= moments_.back().stamp_s)) {
    moments_.clear();
  }
  is_world_ = is_world;
  std::erase_if(moments_,
                [&](const Moment& moment) { return moment.stamp_s < stamp_s - motion_s; });
  moments_.push_back({stamp_s, frame_from_object});
}

// The line that fits the last places best.
std::optional<RigidTransform> ObjectTrack::at(double stamp_s, bool is_world) const {
  if (moments_.empty() || is_world != is_world_) return std::nullopt;
  const Moment& last = moments_.back();
  if (stamp_s < last.stamp_s || stamp_s > last.stamp_s + longest_s) return std::nullopt;
  double mean_s = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Moment& moment : moments_) {
    mean_s += moment.stamp_s - last.stamp_s;
    mean += moment.frame_from_object.translation;
  }
  const auto count = static_cast<double>(moments_.size());
  mean_s /= count;
  mean /= count;
  double squares = 0;
  Eigen::Vector3d products = Eigen::Vector3d::Zero();
  for (const Moment& moment : moments_) {
    const double t = moment.stamp_s - last.stamp_s - mean_s;
    squares += t * t;
    products += t * (moment.frame_from_object.translation - mean);
  }
  RigidTransform moved = last.frame_from_object;
  if (squares > 0) {
    moved.translation = mean + (stamp_s - last.stamp_s - mean_s) / squares * products;
  }
  return moved;
}

}  // namespace diminish
