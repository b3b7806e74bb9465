#pragma once

#include <optional>
#include <vector>

#include "diminish/diminished_frame.h"
#include "diminish/frame_set.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/rig.h"
#include "diminish/scene.h"
#include "diminish/scene_samples.h"
#include "pose/depth_scale.h"
#include "pose/lens_trial.h"
#include "pose/marker_agreement.h"
#include "pose/object_place.h"
#include "pose/pose_refinement.h"
#include "scene/scene_fit.h"
#include "scene/stream_delay.h"

namespace diminish {

/// Measures in each frame how well the set-up agrees with what its cameras see: poses, depth's
/// scale, clocks, the lens.
class SetUpEvidence {
 public:
  SetUpEvidence(const Rig& rig, const Scene& scene);

  struct Inputs {
    const FrameSet& frame;
    const Poses& measured_poses;
    const OcclusionMasks& masks;
    const SceneSamples& samples;
    const Options& options;
    bool has_earlier_frames;  ///< which the delay is found from
  };
  /// After refinement.refine with this frame. Fills `report.fit`, sets `report.in_doubt`, and says
  /// why (Doubt::judge).
  void judge(const Inputs& inputs, PoseRefinement& refinement, FrameReport& report);

  /// What the frames of one sequence share.
  StreamDelay& delay() { return delay_; }

 private:
  const Rig& rig_;
  SceneFit fit_;
  StreamDelay delay_;
  DepthScale scale_;
  MarkerAgreement agreement_;
  ObjectPlace object_place_;
  LensTrial lens_trial_;
  // By RGB-D camera.
  std::vector<std::optional<double>> late_s_;
  std::vector<std::optional<MarkerScale>> scales_;
  std::vector<std::optional<MarkerShift>> shifts_;
  std::vector<std::optional<PlaceOfObject>> places_;
};

}  // namespace diminish
