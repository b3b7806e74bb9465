#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/image.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/poses.h"
#include "diminish/registry.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// Finds the depth images of the rig's cameras that measure none (`RgbdCamera::measures_depth`).
/// Registered by name; chosen by the option `estimate_depth`.
class DIMINISH_EXPORT DepthEstimator {
 public:
  static constexpr const char* kind = "depth estimation";
  /// Throws Error if it cannot work with this rig and scene.
  using Factory =
      std::function<std::unique_ptr<DepthEstimator>(const Rig& rig, const Scene& scene)>;

  struct Inputs {
    const FrameSet& frame;   ///< cameras that measure no depth have images of zeros
    const Markers& markers;  ///< empty if nothing needs any
    const Poses& poses;
    const OcclusionMasks& masks;
    /// The part of the user's picture that will be drawn; nothing else needs depth.
    const Rect& drawn;
    const Options& options;
    /// By RGB-D camera: whether depth is wanted, which is when its picture and its pose are known.
    const std::vector<bool>& wanted;
  };

  virtual ~DepthEstimator() = default;

  /// Fills the depth images of the wanted cameras, which have the rig's sizes, in the rig's units;
  /// 0 where nothing is known. messages: what hinders it in this frame, in plain words.
  virtual void estimate(const Inputs& inputs, std::vector<Image<std::uint16_t>>& depths,
                        std::vector<std::string>& messages) = 0;
};

}  // namespace diminish
