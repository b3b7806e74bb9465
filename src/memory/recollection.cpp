#include "memory/recollection.h"

#include <algorithm>

#include "memory/keyframe_preparation.h"

namespace diminish {
namespace {

/// Joins neighbours in depth if the gap between them in the picture is narrow: a threshold that
/// grows with the square of the depth.
void join_narrow_gaps(double focal_px, double baseline_m, Options& options) {
  constexpr double widest_px = 3;
  constexpr double reach_m = 0.01;
  constexpr double least_baseline_m = 1e-4;
  options.discontinuity_reach_m = reach_m;
  options.discontinuity_threshold_m =
      widest_px * reach_m * reach_m / (focal_px * std::max(baseline_m, least_baseline_m));
}

}  // namespace

Recollection::Recollection(const Rig& rig, const KeyframeGrid& grid)
    : rig_(keyframe_rig(rig, grid)),
      grid_step_(grid.step()),
      coarse_(rig.color),
      fine_(rig.color, 2 * PoseRefinement::usual_width),
      witness_(rig, grid),
      drawer_(Registry<Reconstructor>::get("cpu")(rig_)),
      depth_(1),
      masks_(keyframe_masks(rig, grid)),
      edges_(rig.color, grid) {}

void Recollection::prepare(std::shared_ptr<const Keyframe> kept, const RecallInputs& inputs,
                           const std::vector<Testimony>& now) {
  keyframe_ = std::move(kept);
  const Keyframe& keyframe = *keyframe_;
  frame_.color = inputs.frame.color.view();
  show(keyframe, frame_);
  poses_.color_from_depth.assign(1, RigidTransform());
  samples_.surfaces.clear();
  for (const SceneSample& sample : keyframe.samples) {
    // It may have been removed since.
    const int x = static_cast<int>(sample.texture.x()) / grid_step_;
    const int y = static_cast<int>(sample.texture.y()) / grid_step_;
    if (keyframe.depth(x, y) != 0) samples_.surfaces.push_back(sample);
  }
  coarse_.apply(*inputs.poses.color_from_world * keyframe.color_from_world.inverse(), poses_,
                samples_);
  for (PoseRefinement* refinement : {&coarse_, &fine_}) {
    if (const auto correction = refinement->refine(frame_, inputs.masks.color, samples_)) {
      refinement->apply(*correction, poses_, samples_);
    }
  }
  color_maps_.fit(inputs.frame.color, inputs.masks.color, samples_.surfaces, ColorMapModel::affine);
  witness_.judge({keyframe, *poses_.color_from_depth[0], now, inputs.poses, inputs.region},
                 depth_[0], gone_);
}

void Recollection::draw(const RecallInputs& inputs) {
  Options options = inputs.options;
  join_narrow_gaps(rig_.color.fx, baseline_m(), options);
  drawer_->reconstruct(frame_, depth_, poses_, masks_, inputs.region, options, drawn_);
  edges_.close(
      {keyframe_->picture, depth_[0], FloatTransform(poses_.color_from_depth[0]->inverse())},
      inputs.masks.color, inputs.region, drawn_);
}

}  // namespace diminish
