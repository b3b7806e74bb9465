#pragma once

#include <memory>
#include <string>

#include "diminish/diminished_frame.h"
#include "diminish/reconstructor.h"

namespace diminish {

/// The reconstruction backend that Options::backend names. Where a GPU fails in a frame, the
/// processor draws it, and the next frame begins with a new context.
class Backend {
 public:
  explicit Backend(const Rig& rig) : rig_(rig) {}

  /// name: of a registered Reconstructor, or "auto". Throws Error where it cannot work here.
  void choose(const std::string& name);

  /// Reconstructor::reconstruct by the chosen backend. Fills `report`.
  void reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                   const OcclusionMasks& masks, const TiledRegion& region, const Options& options,
                   Reconstruction& reconstruction, DrawingReport& report);
  /// Why the last frame was not drawn by the chosen backend; empty where it was.
  const std::string& message() const { return message_; }

 private:
  Reconstructor& processor();

  Rig rig_;
  std::string name_;
  std::unique_ptr<Reconstructor> chosen_, processor_;
  std::string message_;
};

}  // namespace diminish
