#include "diminish/runner.h"

#include <oneapi/tbb/concurrent_queue.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <memory>
#include <vector>

#include "diminish/pipeline.h"

namespace diminish {
namespace {

/// A frame on its way, with the pipeline that works on it: everything that one thread needs.
struct Slot {
  explicit Slot(Pipeline pipeline_) : pipeline(std::move(pipeline_)) {}

  Pipeline pipeline;
  FrameSet frame;
  DiminishedFrame result;
};

}  // namespace

std::size_t run(FrameSource& source, const Rig& rig, const Scene& scene, const Options& options,
                FrameSink& sink, const RunnerOptions& runner_options) {
  namespace tbb = oneapi::tbb;
  const int threads = std::max(1, runner_options.threads);
  std::vector<std::unique_ptr<Slot>> slots;
  tbb::concurrent_bounded_queue<Slot*> free_slots;
  for (int i = 0; i < threads; ++i) {
    slots.push_back(std::make_unique<Slot>(Pipeline(rig, scene, options)));
    free_slots.push(slots.back().get());
  }

  std::size_t frames_done = 0;
  const auto read = [&](tbb::flow_control& control) -> Slot* {
    Slot* slot = nullptr;
    const bool stopped = runner_options.stop && runner_options.stop->load();
    // There are as many slots as frames in work, so that one is always free here.
    if (stopped || !free_slots.try_pop(slot) || !source.next(slot->frame)) {
      control.stop();
      return nullptr;
    }
    return slot;
  };
  const auto process = [&](Slot* slot) {
    slot->pipeline.process(slot->frame, slot->result);
    if (!slot->result.report.skipped) sink.write_images(slot->frame, slot->result);
    return slot;
  };
  const auto finish = [&](Slot* slot) {
    sink.append(slot->frame, slot->result);
    free_slots.push(slot);
    ++frames_done;
    if (runner_options.progress) runner_options.progress(frames_done);
  };

  tbb::task_arena(threads).execute([&] {
    tbb::parallel_pipeline(
        static_cast<std::size_t>(threads),
        tbb::make_filter<void, Slot*>(tbb::filter_mode::serial_in_order, read) &
            tbb::make_filter<Slot*, Slot*>(tbb::filter_mode::parallel, process) &
            tbb::make_filter<Slot*, void>(tbb::filter_mode::serial_in_order, finish));
  });
  return frames_done;
}

}  // namespace diminish
