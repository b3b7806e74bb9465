#pragma once

#include <vector>

#include "diminish/frame_set.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/reconstruction.h"
#include "diminish/rig.h"
#include "reconstruct/depth_mesh.h"

namespace diminish {

/// Takes Reconstruction::samples from the RGB-D images: on a regular grid of depth pixels, those
/// that lie on surfaces.
class SceneSampler {
 public:
  explicit SceneSampler(const Rig& rig);

  /// masks: grown already. region: of the colour camera's picture, to be drawn later. `samples` is
  /// sorted by `source`. Cost: about 0.1 us a sample.
  void sample(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
              const Rect& region, Reconstruction& reconstruction);

  /// The part of an RGB-D camera's depth image that shows the region, generously.
  const Rect& part(std::size_t camera) const { return by_camera_[camera].part; }

 private:
  struct Camera {
    DepthMesh mesh;
    std::vector<SceneSample> samples;
    std::vector<Eigen::Vector3f> object_points_m;
    Rect part;
  };
  void sample_camera(const RgbdFrame& images, const DepthMesh::Frame& frame, const Rect& region,
                     std::uint8_t source, Camera& camera) const;

  std::vector<Camera> by_camera_;
};

}  // namespace diminish
