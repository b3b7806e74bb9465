#pragma once

#include <functional>
#include <memory>

#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/poses.h"
#include "diminish/registry.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// Finds where the cameras are in a frame. Registered by name; `pose.source` in rig.yaml chooses.
class DIMINISH_EXPORT PoseSource {
 public:
  static constexpr const char* kind = "pose source";
  /// `rig.pose` holds the source's own settings. Throws Error on wrong ones.
  using Factory = std::function<std::unique_ptr<PoseSource>(const Rig& rig, const Scene& scene)>;

  virtual ~PoseSource() = default;

  /// Whether `markers` must hold the markers of the colour images.
  virtual bool needs_markers() const = 0;

  /// Fills what it can find out; `poses` comes with every entry absent, one per RGB-D camera. What
  /// follows from the rest (`color_from_depth` from two world poses, and back) is filled in later.
  virtual void estimate(const FrameSet& frame, const Markers& markers, Poses& poses) = 0;
};

}  // namespace diminish
