#pragma once

#include <vector>

#include "core/rows.h"
#include "diminish/frame_set.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "diminish/scene_samples.h"
#include "render/depth_mesh.h"

namespace diminish {

/// Takes samples of the scene from the RGB-D images: those depth pixels of a regular grid that lie
/// on surfaces.
class SceneSampler {
 public:
  explicit SceneSampler(const Rig& rig);

  /// masks: already grown. Cost: about 0.1 us per sample.
  void sample(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
              SceneSamples& samples);

 private:
  /// Samples from a band of a depth image.
  struct Band {
    std::vector<SceneSample> samples;
    std::vector<Eigen::Vector3f> object_points_m;
  };
  struct Camera {
    DepthMesh mesh;
    Band bands[most_bands];
  };
  struct View {
    const RgbdFrame& images;
    const DepthMesh& mesh;
    DepthMesh::Frame frame;
    std::uint8_t source;
  };
  static void sample_rows(const View& view, Rows rows, Band& band);

  std::vector<Camera> by_camera_;
};

}  // namespace diminish
