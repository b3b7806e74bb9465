#pragma once

#include <string>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/intrinsics.h"
#include "diminish/marker_detector.h"
#include "diminish/poses.h"
#include "diminish/rig.h"

namespace diminish {

/// Finds the markers in all colour images of a frame, each image in its own thread.
class FrameMarkers {
 public:
  /// wanted: if false, none are looked for. Throws Error for an unknown dictionary.
  FrameMarkers(const Rig& rig, const std::string& dictionary, bool wanted);

  bool are_wanted() const { return !cameras_.empty(); }

  /// Cameras without an image have none; a remote one's have been found.
  void find(const FrameSet& frame, Markers& markers);

 private:
  struct Camera {
    Lens lens;
    MarkerDetector detector;
  };
  std::vector<Camera> cameras_;  ///< the colour camera, then the RGB-D cameras
};

}  // namespace diminish
