#include "pipeline/backend.h"

#include <chrono>

#include "diminish/error.h"
#ifdef DIMINISH_HAS_GL
#include "gl/context.h"
#endif

namespace diminish {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* on_processor = "cpu";

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

bool gpu_is_there() {
#ifdef DIMINISH_HAS_GL
  static const bool is_there = gl::has_hardware_driver();
  return is_there;
#else
  return false;
#endif
}

}  // namespace

void Backend::choose(const std::string& name) {
  const std::string meant = name != "auto" ? name : gpu_is_there() ? "gl" : on_processor;
  if (meant == name_) return;
  chosen_ = Registry<Reconstructor>::get(meant)(rig_);
  name_ = meant;
}

std::string Backend::mask_drawer() const {
  return name_.starts_with("gl") && gpu_is_there() ? "gl" : on_processor;
}

Reconstructor& Backend::chosen() {
  if (!chosen_) chosen_ = Registry<Reconstructor>::get(name_)(rig_);
  return *chosen_;
}

Reconstructor& Backend::processor() {
  if (!processor_) processor_ = Registry<Reconstructor>::get(on_processor)(rig_);
  return *processor_;
}

/// The next frame begins anew.
void Backend::give_up(const Error& error, Reconstruction& reconstruction) {
  chosen_.reset();
  // In whatever state it is: the next to draw begins anew.
  reconstruction.color.resize(0, 0);
  message_ = std::string(error.what()) + "; drawn by the processor instead";
}

Reach Backend::reach(const Options& options) {
  try {
    const auto* composing = dynamic_cast<const ComposingReconstructor*>(&chosen());
    if (composing) return composing->reach(options);
  } catch (const Error&) {
    // Drawing will fail in the same way, and say so.
  }
  return Reach::reconstruction;
}

Reach Backend::compose(const FrameInputs& inputs, DiminishedFrame& result) {
  const Clock::time_point start = Clock::now();
  DrawingReport& report = result.report.drawing;
  try {
    auto& composing = dynamic_cast<ComposingReconstructor&>(chosen());
    composing.compose(inputs, result);
    report.device = composing.device();
    report.passes = composing.gpu_passes();
    report.milliseconds = milliseconds_since(start);
    return composing.reach(inputs.options);
  } catch (const Error& error) {
    give_up(error, result.reconstruction);
    return Reach::reconstruction;
  }
}

void Backend::reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                          const OcclusionMasks& masks, const TiledRegion& region,
                          const Options& options, Reconstruction& reconstruction,
                          DrawingReport& report) {
  const Clock::time_point start = Clock::now();
  const auto draw_by = [&](Reconstructor& reconstructor) {
    reconstructor.reconstruct(frame, depths, poses, masks, region, options, reconstruction);
    report.device = reconstructor.device();
    report.passes = reconstructor.gpu_passes();
  };
  if (message_.empty()) {
    try {
      draw_by(chosen());
    } catch (const Error& error) {
      if (name_ == on_processor) throw;
      give_up(error, reconstruction);
    }
  }
  if (!message_.empty()) draw_by(processor());
  report.milliseconds = milliseconds_since(start);
}

}  // namespace diminish
