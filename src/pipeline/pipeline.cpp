#include "diminish/pipeline.h"

#include <oneapi/tbb/task_arena.h>

#include <tuple>

#include "diminish/validate.h"
#include "pipeline/frame_stages.h"

namespace diminish {

struct Pipeline::Implementation : FrameStages {
  using FrameStages::FrameStages;
};

Pipeline::Pipeline(const Rig& rig, const Scene& scene, const Options& options) {
  validate(rig);
  validate(scene, rig);
  implementation_ = std::make_unique<Implementation>(rig, scene);
  set_options(options);
}
Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

void Pipeline::set_options(const Options& options) {
  implementation_->set_options(options);
}
bool Pipeline::needs_markers() const {
  return implementation_->markers.are_wanted();
}
void Pipeline::want_reconstruction(bool wanted) {
  implementation_->wants_reconstruction = wanted;
}
void Pipeline::want_texture(const std::optional<GlSharing>& application) {
  Implementation& self = *implementation_;
  self.texture.put_to(nullptr);
  if (application) self.texture.put_to(make_texture_output(*application, self.rig.color));
}
const GlTexture& Pipeline::texture() const {
  return implementation_->texture.texture();
}
const Options& Pipeline::options() const {
  return implementation_->options;
}

void Pipeline::share_memory(Pipeline& other) {
  std::apply(
      [&](auto&... own) {
        std::apply([&](auto&... others) { (own.share(others), ...); },
                   other.implementation_->shared());
      },
      implementation_->shared());
}
void Pipeline::take_turn() {
  std::apply([](auto&... shared) { (shared.take_turn(), ...); }, implementation_->shared());
}
void Pipeline::pass_turn() {
  std::apply([](auto&... shared) { (shared.end_turn(), ...); }, implementation_->shared());
}
void Pipeline::forget() {
  implementation_->memory.forget();
  implementation_->doubt.forget();
  implementation_->inventions.steady().forget();
  implementation_->inventions.known_bars().forget();
}

void Pipeline::set_background(const Scan& scan) {
  implementation_->memory.set_background(scan, implementation_->scene);
}
Scan Pipeline::scan() {
  return implementation_->memory.scan(implementation_->scene);
}

void Pipeline::process(const FrameSet& frame, DiminishedFrame& result) {
  take_turn();
  const struct Pass {
    Pipeline& pipeline;
    ~Pass() {
      pipeline.implementation_->begun_stage = FrameStages::no_stage;
      pipeline.pass_turn();
    }
  } pass{*this};
  // Our own loops begin nothing else while they wait; a registered method may use oneTBB's.
  oneapi::tbb::this_task_arena::isolate([&] { implementation_->process(frame, result); });
}

std::optional<Stage> Pipeline::stage() const {
  const int begun = implementation_->begun_stage;
  return begun == FrameStages::no_stage ? std::nullopt : std::optional(static_cast<Stage>(begun));
}

}  // namespace diminish
