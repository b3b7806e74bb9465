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

/// Finds the cameras' poses in a frame. Registered by name; chosen by `pose.source` in rig.yaml.
class DIMINISH_EXPORT PoseSource {
 public:
  static constexpr const char* kind = "pose source";
  /// `rig.pose` holds the source's own settings. Throws Error on wrong ones.
  using Factory = std::function<std::unique_ptr<PoseSource>(const Rig& rig, const Scene& scene)>;

  virtual ~PoseSource() = default;

  /// Whether `markers` must hold the markers of the colour images.
  virtual bool needs_markers() const = 0;

  /// Fills in the poses that it can find. `poses` comes empty, with one entry per RGB-D camera.
  /// What follows from others (`color_from_depth` from two world poses, and back) is filled in
  /// later.
  virtual void estimate(const FrameSet& frame, const Markers& markers, Poses& poses) = 0;
};

}  // namespace diminish
