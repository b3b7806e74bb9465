#pragma once

#include <functional>
#include <memory>

#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/poses.h"
#include "diminish/registry.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// What a detector may look at: this frame, and what is known of it so far.
struct Observation {
  const FrameSet& frame;
  const Markers& markers;
  const Poses& poses;
  const Options& options;
};

/// Finds one object to remove. Registered by name; `detector` in scene.yaml chooses.
class DIMINISH_EXPORT OccluderDetector {
 public:
  static constexpr const char* kind = "detector";
  /// `spec.config` holds the detector's own settings. Throws Error on wrong ones.
  using Factory =
      std::function<std::unique_ptr<OccluderDetector>(const OccluderSpec& spec, const Rig& rig)>;

  virtual ~OccluderDetector() = default;

  /// Whether the observation must hold the markers of the colour images.
  virtual bool needs_markers() const { return false; }

  /// Sets the object's pixels in `masks` to 255 and leaves the others alone. `masks` has the rig's
  /// sizes. Cameras without images in this frame are left alone too.
  virtual OccluderReport detect(const Observation& observation, OcclusionMasks& masks) = 0;
};

}  // namespace diminish
