#include "memory/rgbd_viewpoint.h"

#include "geometry/point_projection.h"

namespace diminish {

RgbdViewpoint::RgbdViewpoint(const Rig& rig, std::size_t index)
    : camera_(rig.rgbd[index]),
      index_(index),
      users_(rig.color),
      lens_(Lens(rig.color)),
      box_(rig.color.bounds()) {}

bool RgbdViewpoint::go(const RecallInputs& inputs) {
  poses_.color_from_world.reset();
  const auto& depth_from_world = inputs.poses.depth_from_world[index_];
  if (!inputs.frame.rgbd[index_].available() || !depth_from_world ||
      !inputs.poses.color_from_depth[index_]) {
    return false;
  }
  poses_.color_from_world = camera_.color_from_depth * *depth_from_world;
  return true;
}

KeyframeView RgbdViewpoint::look(const RecallInputs& inputs, const SceneSamples& samples) {
  if (!change_) change_.emplace(camera_.color, users_);
  change_->show(inputs.frame.rgbd[index_].color, picture_);
  change_->hide(inputs.masks.rgbd_color[index_], objects_);
  const RigidTransform here_from_user =
      *poses_.color_from_world * inputs.poses.color_from_world->inverse();
  poses_.depth_from_world = inputs.poses.depth_from_world;
  poses_.color_from_depth = inputs.poses.color_from_depth;
  for (auto& pose : poses_.color_from_depth) {
    if (pose) pose = here_from_user * *pose;
  }
  const FloatTransform to_here(here_from_user);
  samples_.surfaces.clear();
  for (SceneSample sample : samples.surfaces) {
    sample.point_m = transform(to_here, sample.point_m);
    const auto pixel = project(lens_, sample.point_m);
    if (!pixel || !box_.contains(pixel->x, pixel->y)) continue;
    sample.pixel = {static_cast<float>(pixel->x), static_cast<float>(pixel->y)};
    samples_.surfaces.push_back(sample);
  }
  return {poses_, picture_, objects_, box_, samples_};
}

}  // namespace diminish
