#include "pipeline/backend.h"

#include <chrono>

#include "diminish/error.h"
#ifdef DIMINISH_HAS_GL
#include "gl/context.h"
#endif

namespace diminish {
namespace {

constexpr const char* on_processor = "cpu";

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

Reconstructor& Backend::processor() {
  if (!processor_) processor_ = Registry<Reconstructor>::get(on_processor)(rig_);
  return *processor_;
}

void Backend::reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                          const OcclusionMasks& masks, const TiledRegion& region,
                          const Options& options, Reconstruction& reconstruction,
                          DrawingReport& report) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  message_.clear();
  const auto draw_by = [&](Reconstructor& reconstructor) {
    reconstructor.reconstruct(frame, depths, poses, masks, region, options, reconstruction);
    report.device = reconstructor.device();
    report.passes = reconstructor.gpu_passes();
  };
  try {
    if (!chosen_) chosen_ = Registry<Reconstructor>::get(name_)(rig_);
    draw_by(*chosen_);
  } catch (const Error& error) {
    if (name_ == on_processor) throw;
    chosen_.reset();
    // In whatever state it is: the next to draw begins anew.
    reconstruction.color.resize(0, 0);
    message_ = std::string(error.what()) + "; drawn by the processor instead";
    draw_by(processor());
  }
  report.milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace diminish
