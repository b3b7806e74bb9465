#pragma once

#include <optional>
#include <vector>

#include "depth/depth_cleaner.h"
#include "depth/visible_blocks.h"
#include "diminish/frame_set.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/poses.h"
#include "diminish/reconstructor.h"
#include "diminish/rig.h"
#include "diminish/tiled_region.h"

namespace diminish {

/// Prepares one camera's depth images for drawing.
class CameraDepth {
 public:
  CameraDepth(const RgbdCamera& camera, const Intrinsics& color)
      : cleaner_(camera), visible_(camera, color) {}

  /// The camera's masks.
  struct Masks {
    const Mask& color;
    const Mask& depth;
  };
  /// Cleans what may be visible in the colour camera's picture; see DepthStage::clean.
  void clean(const RgbdFrame& images, const std::optional<RigidTransform>& color_from_depth,
             const Masks& masks, const TiledRegion& drawn, const Options& options,
             Image<std::uint16_t>& depth);

 private:
  // A cleaner keeps the camera's rays; then the blocks need not make them anew.
  DepthCleaner cleaner_;
  VisibleBlocks visible_;
};

/// Prepares all depth images for drawing: cleans what may be visible in the colour camera's
/// picture.
class DepthStage {
 public:
  explicit DepthStage(const Rig& rig);

  /// poses: as measured. drawn: the part of the picture that will be drawn after poses are refined.
  void clean(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
             const TiledRegion& drawn, const Options& options);
  /// Unspecified for cameras without images or without a pose.
  const DepthImages& depths() const { return depths_; }

 private:
  std::vector<CameraDepth> cameras_;
  DepthImages depths_;
};

}  // namespace diminish
