#include "memory/memory_stage.h"

#include <span>

#include "core/tasks.h"

namespace diminish {

void MemoryStage::remember(const RecallInputs& inputs, const SceneSamples& samples,
                           const std::vector<OccluderReport>& objects,
                           Reconstruction& reconstruction) {
  const Poses poses = anchored(inputs.poses);
  if (!poses.color_from_world) return;
  const RecallInputs anchored_inputs{inputs.frame,   poses,         inputs.masks,
                                     inputs.objects, inputs.region, inputs.color_maps,
                                     inputs.options};
  shared_->turns.wait(*turn_);
  if (!shared_->memory) shared_->memory.emplace(shared_->rig);
  const std::size_t count = shared_->memory->recall(anchored_inputs, recollections_);
  shared_->memory->learn(anchored_inputs, samples, objects);
  end_turn();
  if (count == 0) return;
  for_tasks(count, [&](std::size_t i) { recollections_[i].draw(anchored_inputs); });
  merge_.merge(anchored_inputs, std::span(recollections_).first(count),
               inputs.options.memory == "witnessed", reconstruction);
}

void MemoryStage::forget() {
  const Turn turn(*this);
  shared_->turns.wait(*turn_);
  if (shared_->memory) shared_->memory->forget();
}

}  // namespace diminish
