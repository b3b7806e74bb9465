#pragma once

#include <vector>

#include "diminish/frame_set.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/reconstructor.h"
#include "diminish/rig.h"
#include "reconstruct/depth_mesh.h"

namespace diminish {

/// Takes Reconstruction::samples from the RGB-D images: on a regular grid of depth pixels, those
/// that lie on surfaces.
class SceneSampler {
 public:
  explicit SceneSampler(const Rig& rig);

  /// masks: grown already. Cost: about 0.1 us a sample; `samples` is sorted by `source`.
  void sample(const FrameSet& frame, const DepthImages& depths, const Poses& poses, const OcclusionMasks& masks,
              std::vector<SceneSample>& samples);

 private:
  void sample_camera(const FrameSet& frame, const DepthImages& depths, const Poses& poses, const OcclusionMasks& masks,
                     std::size_t k, std::vector<SceneSample>& samples) const;

  Intrinsics color_;
  std::vector<DepthMesh> meshes_;
  std::vector<std::vector<SceneSample>> by_camera_;
};

}  // namespace diminish
