#pragma once

#include <memory>

#include "diminish/pose_source.h"

namespace diminish {

/// Finds all cameras' poses in a frame: asks the rig's pose source, then adds what follows from its
/// answer.
class CameraPoses {
 public:
  /// Throws Error if the source is unknown or its settings are wrong.
  CameraPoses(const Rig& rig, const Scene& scene);

  bool needs_markers() const { return source_->needs_markers(); }
  void estimate(const FrameSet& frame, const Markers& markers, Poses& poses);

 private:
  std::unique_ptr<PoseSource> source_;
  std::size_t rgbd_count_;
};

/// Adds `color_from_depth` where both world poses are known, and world poses that follow from
/// another camera's.
void complete(Poses& poses);

}  // namespace diminish
