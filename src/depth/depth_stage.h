#pragma once

#include <vector>

#include "depth/depth_cleaner.h"
#include "depth/visible_blocks.h"
#include "diminish/frame_set.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/poses.h"
#include "diminish/reconstructor.h"
#include "diminish/rig.h"

namespace diminish {

/// Prepares all depth images for drawing: cleans what may be visible in the colour camera's
/// picture.
class DepthStage {
 public:
  explicit DepthStage(const Rig& rig);

  /// poses: as measured. drawn: the part of the picture that will be drawn after poses are refined.
  void clean(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
             const Rect& drawn, const Options& options);
  /// Unspecified for cameras without images or without a pose.
  const DepthImages& depths() const { return depths_; }

 private:
  std::vector<VisibleBlocks> visible_;
  std::vector<DepthCleaner> cleaners_;
  DepthImages depths_;
};

}  // namespace diminish
