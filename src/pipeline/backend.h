#pragma once

#include <memory>
#include <string>

#include "composite/composing_reconstructor.h"
#include "diminish/error.h"

namespace diminish {

/// The reconstruction backend that Options::backend names. Where a GPU fails in a frame, the
/// processor draws it, and the next frame begins with a new context.
class Backend {
 public:
  explicit Backend(const Rig& rig) : rig_(rig) {}

  /// name: of a registered Reconstructor, or "auto". Throws Error where it cannot work here.
  void choose(const std::string& name);

  /// The MaskDrawer that goes with it: the GPU's where hardware draws. A software driver would
  /// only take longer.
  std::string mask_drawer() const;

  /// Forgets what failed in the last frame.
  void begin_frame() { message_.clear(); }
  /// How far `compose` goes by the chosen backend, where it does not fail.
  Reach reach(const Options& options);
  /// Goes so far; fills `result.report.drawing`, too. Where it fails the frame is the processor's
  /// from the beginning: returns Reach::reconstruction, and nothing is drawn yet.
  Reach compose(const FrameInputs& inputs, DiminishedFrame& result);

  /// Reconstructor::reconstruct by the chosen backend. Fills `report`.
  void reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                   const OcclusionMasks& masks, const TiledRegion& region, const Options& options,
                   Reconstruction& reconstruction, DrawingReport& report);
  /// Why the frame was not drawn by the chosen backend; empty where it was.
  const std::string& message() const { return message_; }

 private:
  Reconstructor& chosen();
  Reconstructor& processor();
  void give_up(const Error& error, Reconstruction& reconstruction);

  Rig rig_;
  std::string name_;
  std::unique_ptr<Reconstructor> chosen_, processor_;
  std::string message_;
};

}  // namespace diminish
