#pragma once

#include <span>

#include "diminish/frame_set.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/poses.h"
#include "diminish/tiled_region.h"
#include "estimate/plane_depth.h"

namespace diminish {

/// What there is of a frame when something is to be remembered in it.
struct RecallInputs {
  const FrameSet& frame;
  const Poses& poses;  ///< refined; color_from_world is known
  const OcclusionMasks& masks;
  const Rect& objects;        ///< their box in the picture
  const TiledRegion& region;  ///< that is drawn
  const Options& options;
  const bool& is_in_doubt;  ///< known once the frame's samples are taken: nothing is learnt then
  /// Of a rig without RGB-D cameras: where the user's camera sees a surface; in its frame.
  std::span<const InversePlane> planes = {};
};

}  // namespace diminish
