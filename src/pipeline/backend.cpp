#include "pipeline/backend.h"

#include <algorithm>

#include "diminish/error.h"
#include "pipeline/stage_timer.h"
#include "reconstruct/clear_outside.h"

namespace diminish {
namespace {

using Suited = Reconstructor::Suited;

/// The registered backend that suits best, up to `most`.
std::string best_suited(Suited most) {
  std::string best;
  Suited best_suited = Suited::when_named;
  for (const std::string& name : Registry<Reconstructor>::names()) {
    const Suited suited = Registry<Reconstructor>::get(name).suited();
    if (suited <= best_suited || suited > most) continue;
    best = name;
    best_suited = suited;
  }
  return best;
}

/// What the stages after the drawing look at, if nobody else does.
Reconstructor::Colors wanted_colors(const FrameInputs& inputs) {
  const bool only_maps = inputs.methods.color.rule != ColorCorrector::Declaration::Rule::own;
  return inputs.wants_reconstruction || inputs.methods.remembers || !only_maps
             ? Reconstructor::Colors::all
             : Reconstructor::Colors::sparse;
}

bool has_remote(const FrameSet& frame) {
  return std::any_of(frame.rgbd.begin(), frame.rgbd.end(),
                     [](const RgbdFrame& rgbd) { return rgbd.is_remote(); });
}

/// The last stage that a backend takes over.
Stage last_stage(const ComposingReconstructor& backend, const FrameMethods& methods) {
  auto last = static_cast<std::size_t>(Stage::drawing);
  while (last + 1 < stage_count && backend.takes_over(static_cast<Stage>(last + 1), methods)) {
    ++last;
  }
  return static_cast<Stage>(last);
}

}  // namespace

void Backend::choose(const std::string& name) {
  const std::string meant = name == "auto" ? best_suited(Suited::with_hardware) : name;
  if (meant == name_) return;
  chosen_ = Registry<Reconstructor>::get(meant)(rig_);
  name_ = meant;
  attempts_ = {};
}

Reconstructor& Backend::chosen() {
  if (!chosen_) chosen_ = Registry<Reconstructor>::get(name_)(rig_);
  return *chosen_;
}

void Backend::draw(const FrameInputs& inputs, DiminishedFrame& result) {
  const ScopedTimer timer(result.report.drawing.milliseconds);
  if (has_remote(inputs.frame) && !chosen().merges_remote()) {
    message_ = name_ + ": only the CPU merges what other machines have drawn";
  } else {
    if (attempts_.is_due() && try_chosen(inputs, result)) return;
    message_ = failure_ + "; drawn by the CPU instead";
  }
  if (!fallback_) fallback_ = Registry<Reconstructor>::get(best_suited(Suited::always))(rig_);
  reconstruct(*fallback_, inputs, result);
}

bool Backend::try_chosen(const FrameInputs& inputs, DiminishedFrame& result) {
  try {
    draw_by_chosen(inputs, result);
    attempts_.succeed();
    return true;
  } catch (const Error& error) {
    if (Registry<Reconstructor>::get(name_).suited() == Suited::always) throw;
    attempts_.fail();
    failure_ = error.what();
    // All begins anew: what was drawn may be in any state.
    chosen_.reset();
    // What learns beside one that only draws asks what it has done.
    if (last_ != Stage::drawing) last_ = Stage::drawing;
    result.reconstruction.color.resize(0, 0);
    return false;
  }
}

void Backend::draw_by_chosen(const FrameInputs& inputs, DiminishedFrame& result) {
  Reconstructor& backend = chosen();
  auto* const composing = dynamic_cast<ComposingReconstructor*>(&backend);
  if (composing) last_ = last_stage(*composing, inputs.methods);
  if (last_ == Stage::drawing) return reconstruct(backend, inputs, result);
  composing->compose(inputs, last_, result);
  result.report.drawing.device = backend.device();
  result.report.drawing.passes = backend.gpu_passes();
}

void Backend::reconstruct(Reconstructor& reconstructor, const FrameInputs& inputs,
                          DiminishedFrame& result) const {
  result.report.drawing.device = reconstructor.device();
  if (inputs.region.empty()) {
    // Then nothing was prepared that could be drawn.
    clear_outside(rig_.color, inputs.region, result.reconstruction);
    resize_second(false, rig_.color, result.reconstruction.second);
    return;
  }
  reconstructor.want_colors(wanted_colors(inputs));
  reconstructor.reconstruct(inputs.frame, inputs.depths, inputs.poses, inputs.masks, inputs.region,
                            inputs.options, result.reconstruction);
  result.report.drawing.passes = reconstructor.gpu_passes();
}

}  // namespace diminish
