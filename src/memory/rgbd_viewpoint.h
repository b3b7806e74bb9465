#pragma once

#include <cstddef>
#include <optional>

#include "memory/keyframe_taker.h"
#include "memory/lens_change.h"

namespace diminish {

/// What the user's camera would see if it were where an RGB-D camera's colour sensor is.
class RgbdViewpoint {
 public:
  /// index: of the RGB-D camera.
  RgbdViewpoint(const Rig& rig, std::size_t index);

  /// Finds where that is. False if the camera has no images in this frame, or no pose.
  bool go(const RecallInputs& inputs);
  /// Where it went last; nothing if that failed.
  const std::optional<RigidTransform>& color_from_world() const { return poses_.color_from_world; }
  /// After go. samples: of the frame. The view is of this object. Cost: LensChange's, twice.
  KeyframeView look(const RecallInputs& inputs, const SceneSamples& samples);

 private:
  RgbdCamera camera_;
  std::size_t index_;
  Intrinsics users_;
  Projection lens_;
  std::optional<LensChange> change_;  ///< made when it is needed
  Poses poses_;
  Image<Bgr> picture_;
  Mask objects_;
  Rect box_;
  SceneSamples samples_;
};

}  // namespace diminish
