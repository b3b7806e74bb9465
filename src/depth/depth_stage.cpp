#include "depth/depth_stage.h"

#include "core/tasks.h"

namespace diminish {
namespace {

/// In the picture: what the refinement of poses may move.
constexpr int refinement_margin_px = 24;

}  // namespace

DepthStage::DepthStage(const Rig& rig) : depths_(rig.rgbd.size()) {
  for (const RgbdCamera& camera : rig.rgbd) {
    // A cleaner keeps the camera's rays; then the blocks need not make them anew.
    cleaners_.emplace_back(camera);
    visible_.emplace_back(camera, rig.color);
  }
}

void DepthStage::clean(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
                       const Rect& drawn, const Options& options) {
  for_tasks(depths_.size(), [&](std::size_t k) {
    const RgbdFrame& rgbd = frame.rgbd[k];
    if (!rgbd.available()) return;
    if (poses.color_from_depth[k]) {
      visible_[k].find(rgbd.depth, *poses.color_from_depth[k], grow(drawn, refinement_margin_px));
    } else {
      visible_[k].clear();
    }
    cleaners_[k].clean(rgbd.depth, {rgbd.color, masks.rgbd_color[k], masks.rgbd_depth[k]},
                       visible_[k].part(), options, depths_[k]);
  });
}

}  // namespace diminish
