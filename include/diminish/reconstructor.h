#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/gpu_pass.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/poses.h"
#include "diminish/reconstruction.h"
#include "diminish/registry.h"
#include "diminish/rig.h"

namespace diminish {

/// One for each RGB-D camera, in its own units; 0: nothing to draw.
using DepthImages = std::vector<Image<std::uint16_t>>;

/// Draws what the RGB-D cameras see, without the objects, from the colour camera's viewpoint.
/// Registered by name: one per implementation ("reference", ...).
class Reconstructor {
 public:
  static constexpr const char* kind = "reconstruction backend";
  using Factory = std::function<std::unique_ptr<Reconstructor>(const Rig& rig)>;

  virtual ~Reconstructor() = default;

  /// depths: of each RGB-D camera, what is to be drawn of its depth image. masks: grown already.
  /// region: the part to draw, inside the colour image; tiles that do not belong to it come out
  /// empty. RGB-D cameras without images or without a pose in this frame take no part.
  virtual void reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                           const OcclusionMasks& masks, const TiledRegion& region,
                           const Options& options, Reconstruction& reconstruction) = 0;

  /// The GPU that draws, by its driver's name; empty where the processor does.
  virtual const std::string& device() const {
    static const std::string processor;
    return processor;
  }
  /// What the GPU did in the last frame, pass by pass.
  virtual const std::vector<GpuPass>& gpu_passes() const {
    static const std::vector<GpuPass> none;
    return none;
  }
};

}  // namespace diminish
