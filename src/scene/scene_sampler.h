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

struct Glance;

/// Takes samples of the scene from the RGB-D images: those depth pixels of a regular grid that lie
/// on surfaces. Where a camera's images are on another machine, that one has read them (Glance).
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
  static void take_points(const View& view, const Glance& glance, Band& band);
  template <class FindColor>
  static void take(const View& view, int column, int row, Band& band, const FindColor& find_color);

  std::vector<Camera> by_camera_;
};

}  // namespace diminish
