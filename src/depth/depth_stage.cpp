#include "depth/depth_stage.h"

#include "core/tasks.h"

namespace diminish {
namespace {

/// In the picture: what the refinement of poses may move.
constexpr int refinement_margin_px = 24;

}  // namespace

void CameraDepth::clean(const RgbdFrame& images,
                        const std::optional<RigidTransform>& color_from_depth, const Masks& masks,
                        const TiledRegion& drawn, const Options& options,
                        Image<std::uint16_t>& depth) {
  if (color_from_depth) {
    visible_.find(images.depth, *color_from_depth, drawn, refinement_margin_px);
  } else {
    visible_.clear();
  }
  cleaner_.clean(images.depth, {images.color, masks.color, masks.depth}, visible_.part(), options,
                 depth);
}

DepthStage::DepthStage(const Rig& rig) : depths_(rig.rgbd.size()) {
  for (const RgbdCamera& camera : rig.rgbd) cameras_.emplace_back(camera, rig.color);
}

void DepthStage::clean(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
                       const TiledRegion& drawn, const Options& options) {
  for_tasks(depths_.size(), [&](std::size_t k) {
    if (!frame.rgbd[k].available()) return;
    cameras_[k].clean(frame.rgbd[k], poses.color_from_depth[k],
                      {masks.rgbd_color[k], masks.rgbd_depth[k]}, drawn, options, depths_[k]);
  });
}

}  // namespace diminish
