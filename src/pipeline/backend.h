#pragma once

#include <memory>
#include <string>

#include "composite/composing_reconstructor.h"
#include "core/backoff.h"

namespace diminish {

/// The reconstruction backend that Options::backend names. If a GPU fails in a frame, the CPU draws
/// it, and the next frame starts with a new context; if that fails, too, ever later ones.
class Backend {
 public:
  explicit Backend(const Rig& rig) : rig_(rig) {}

  /// name: a registered Reconstructor's, or "auto". Throws Error if it cannot work here.
  void choose(const std::string& name);
  /// Reconstructor::mask_drawer of the chosen backend.
  std::string mask_drawer() { return chosen().mask_drawer(); }

  /// Forgets what failed and what was taken over in the last frame.
  void begin_frame() {
    message_.clear();
    last_ = Stage::drawing;
  }
  /// Whether it does no more than Stage::drawing, for which it need not know what was learnt of the
  /// scene: planes, shadows, colours.
  bool only_draws() const {
    return chosen_ && !dynamic_cast<const ComposingReconstructor*>(chosen_.get());
  }
  /// Does Stage::drawing and the stages after it that the backend takes over. Also fills
  /// `result.report.drawing`.
  void draw(const FrameInputs& inputs, DiminishedFrame& result);
  /// Whether the backend has taken this stage over in this frame.
  bool has_done(Stage stage) const { return stage > Stage::drawing && stage <= last_; }

  /// Why the chosen backend did not draw the frame; empty if it did.
  const std::string& message() const { return message_; }

 private:
  Reconstructor& chosen();
  /// False if the chosen backend fails.
  bool try_chosen(const FrameInputs& inputs, DiminishedFrame& result);
  void draw_by_chosen(const FrameInputs& inputs, DiminishedFrame& result);
  void reconstruct(Reconstructor& reconstructor, const FrameInputs& inputs,
                   DiminishedFrame& result) const;

  Rig rig_;
  std::string name_;
  std::unique_ptr<Reconstructor> chosen_, fallback_;
  Stage last_ = Stage::drawing;  ///< done in this frame
  Backoff attempts_;
  std::string failure_;  ///< the last one
  std::string message_;
};

}  // namespace diminish
