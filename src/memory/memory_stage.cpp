#include "memory/memory_stage.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/tasks.h"
#include "memory/scan_frames.h"

namespace diminish {
namespace {

/// pixels: how many each recollection shows as remembered.
void report_ages(std::span<const Recollection> recollections, std::span<const std::size_t> pixels,
                 double now_s, MemoryReport& report) {
  std::vector<std::pair<double, std::size_t>> ages;
  std::size_t all = 0;
  for (std::size_t i = 0; i < recollections.size(); ++i) {
    if (pixels[i] == 0) continue;
    if (recollections[i].keyframe().is_background) {
      report.background_pixels += pixels[i];
    } else {
      ages.emplace_back(now_s - recollections[i].keyframe().stamp_s, pixels[i]);
      all += pixels[i];
    }
  }
  if (ages.empty()) return;
  std::sort(ages.begin(), ages.end());
  report.oldest_age_s = ages.back().first;
  std::size_t younger = 0;
  for (const auto& [age_s, count] : ages) {
    report.median_age_s = age_s;
    younger += count;
    if (2 * younger >= all) break;
  }
}

RecallInputs with_poses(const RecallInputs& inputs, const Poses& poses) {
  return {inputs.frame,  poses,          inputs.masks,       inputs.objects,
          inputs.region, inputs.options, inputs.is_in_doubt, inputs.planes};
}

}  // namespace

template <class Work>
auto MemoryStage::in_turn(const Work& work) {
  const Turn::Held turn = turn_.hold(shared_->turns);
  return work();
}

void MemoryStage::recall(const RecallInputs& inputs) {
  recalled_ = 0;
  anchor(inputs.poses, poses_);
  if (!poses_.color_from_world) return;
  turn_.wait(shared_->turns);
  if (!shared_->memory) shared_->memory.emplace(shared_->rig);
  const bool is_anchored = !inputs.poses.color_from_world;
  recalled_ = shared_->memory->recall(with_poses(inputs, poses_), is_anchored, recollections_);
}

void MemoryStage::learn(const RecallInputs& inputs, const SceneSamples& samples,
                        const std::vector<OccluderReport>& objects,
                        const std::function<void()>& sample, MemoryReport& report) {
  if (!poses_.color_from_world) return;
  const RecallInputs anchored_inputs = with_poses(inputs, poses_);
  const auto learn_now = [&] {
    const auto sample_and_anchor = [&] {
      sample();
      anchor(inputs.poses, poses_);
    };
    std::function<void()> sample_first;
    if (sample) sample_first = std::ref(sample_and_anchor);
    SceneMemory& memory = *shared_->memory;
    memory.learn(anchored_inputs, samples, objects, sample_first);
    report.keyframes = memory.keyframes();
    report.bytes = memory.bytes();
    turn_.end();
  };
  do_all(learn_now, [&] {
    for_tasks(recalled_, [&](std::size_t i) { recollections_[i].draw(anchored_inputs); });
  });
}

void MemoryStage::merge(const RecallInputs& inputs, ColorMapsBySource color_maps,
                        Reconstruction& reconstruction, MemoryReport& report) {
  background_fit_.reset();
  if (recalled_ == 0) return;
  const auto recalled = std::span(recollections_).first(recalled_);
  merge_.merge(with_poses(inputs, poses_), recalled, color_maps,
               inputs.options.memory == "witnessed", reconstruction);
  const std::vector<std::size_t> pixels = merge_.count_remembered(recalled_, reconstruction);
  report_ages(recalled, pixels, inputs.frame.stamp_s, report);
  if (report.background_pixels > 0) find_background_fit(inputs, pixels);
}

void MemoryStage::find_background_fit(const RecallInputs& inputs,
                                      const std::vector<std::size_t>& pixels) {
  std::size_t most = recalled_;
  for (std::size_t i = 0; i < recalled_; ++i) {
    if (!recollections_[i].keyframe().is_background) continue;
    if (most == recalled_ || pixels[i] > pixels[most]) most = i;
  }
  // Around the objects, if there is texture; else in the whole picture.
  around_.surfaces.clear();
  for (const Recollection::Beside& beside : recollections_[most].beside()) {
    SceneSample& sample = around_.surfaces.emplace_back();
    sample.pixel = {static_cast<float>(beside.x), static_cast<float>(beside.y)};
    sample.color = beside.color;
    sample.source = 1;
  }
  fits_.assign(1, std::nullopt);
  for (const SceneSamples* samples : {&std::as_const(around_), &recollections_[most].samples()}) {
    if (!fits_[0]) fit_.find(inputs.frame.color, inputs.masks.color, *samples, fits_);
  }
  background_fit_ = fits_[0];
}

void MemoryStage::forget() {
  in_turn([&] {
    if (shared_->memory) shared_->memory->forget();
  });
}

void MemoryStage::set_background(const Scan& scan, const Scene& scene) {
  in_turn([&] {
    shared_->memory.emplace(shared_->rig);
    shared_->memory->set_background(keyframes_of(scan, shared_->rig, scene));
  });
}

Scan MemoryStage::scan(const Scene& scene) {
  return in_turn([&] {
    if (!shared_->memory) return make_scan({}, shared_->rig, scene);
    return make_scan(shared_->memory->all(), shared_->rig, scene);
  });
}

}  // namespace diminish
