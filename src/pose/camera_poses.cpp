#include "pose/camera_poses.h"

namespace diminish {

CameraPoses::CameraPoses(const Rig& rig, const Scene& scene) : rgbd_count_(rig.rgbd.size()) {
  source_ = Registry<PoseSource>::get(rig.pose_source)(rig, scene);
}

void CameraPoses::estimate(const FrameSet& frame, const Markers& markers, Poses& poses) {
  poses.color_from_world.reset();
  poses.depth_from_world.assign(rgbd_count_, std::nullopt);
  poses.color_from_depth.assign(rgbd_count_, std::nullopt);
  poses.messages.clear();
  source_->estimate(frame, markers, poses);
  complete(poses);
}

void complete(Poses& poses) {
  for (std::size_t k = 0; k < poses.color_from_depth.size(); ++k) {
    auto& color_from_depth = poses.color_from_depth[k];
    const auto& depth_from_world = poses.depth_from_world[k];
    if (!color_from_depth && poses.color_from_world && depth_from_world) {
      color_from_depth = *poses.color_from_world * depth_from_world->inverse();
    }
    if (!poses.color_from_world && color_from_depth && depth_from_world) {
      poses.color_from_world = *color_from_depth * *depth_from_world;
    }
  }
  if (!poses.color_from_world) return;
  for (std::size_t k = 0; k < poses.color_from_depth.size(); ++k) {
    if (!poses.depth_from_world[k] && poses.color_from_depth[k]) {
      poses.depth_from_world[k] = poses.color_from_depth[k]->inverse() * *poses.color_from_world;
    }
  }
}

}  // namespace diminish
