#include "pipeline/set_up_evidence.h"

#include "pipeline/doubt.h"

namespace diminish {

SetUpEvidence::SetUpEvidence(const Rig& rig, const Scene& scene)
    : rig_(rig),
      fit_(rig.color),
      delay_(rig.color),
      scale_(rig, scene),
      agreement_(rig, scene),
      object_place_(rig, scene),
      lens_trial_(rig, scene) {}

void SetUpEvidence::judge(const Inputs& inputs, PoseRefinement& refinement, FrameReport& report) {
  const auto& [frame, measured_poses, masks, samples, options, has_earlier_frames] = inputs;
  report.fit.resize(rig_.rgbd.size());
  fit_.find(frame.color, masks.color, samples, report.fit);
  scale_.find(frame, report.markers, scales_);
  agreement_.find(frame, report.markers, report.poses, shifts_);
  object_place_.find(frame, report.markers, report.poses, places_);
  late_s_.assign(rig_.rgbd.size(), std::nullopt);
  if (has_earlier_frames && report.poses.color_from_world) {
    delay_.find({frame.color, frame.stamp_s, *report.poses.color_from_world, masks.color, samples},
                late_s_);
  }
  std::optional<double> focal_factor;
  if (options.refine_poses) {
    focal_factor = lens_trial_.find(report.markers, measured_poses, refinement);
  }
  Doubt::judge(rig_, options, {scales_, shifts_, places_, late_s_, focal_factor}, report);
}

}  // namespace diminish
