#include "diminish/runner.h"

#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <vector>

#include "core/happens_before.h"
#include "diminish/pipeline.h"

namespace diminish {
namespace {

/// A frame in progress and the pipeline that works on it: everything that one thread needs.
struct Slot {
  explicit Slot(Pipeline pipeline_) : pipeline(std::move(pipeline_)) {}

  Pipeline pipeline;
  FrameSet frame;
  DiminishedFrame result;
  std::exception_ptr error;  ///< why the frame could not be done
};

/// Those that no frame is in.
class FreeSlots {
 public:
  void put(Slot* slot) {
    const std::lock_guard lock(mutex_);
    slots_.push_back(slot);
  }
  /// Null if there is none.
  Slot* take() {
    const std::lock_guard lock(mutex_);
    if (slots_.empty()) return nullptr;
    Slot* const slot = slots_.back();
    slots_.pop_back();
    return slot;
  }

 private:
  std::mutex mutex_;
  std::vector<Slot*> slots_;
};

}  // namespace

std::size_t run(FrameSource& source, const Rig& rig, const Scene& scene, const Options& options,
                FrameSink& sink, const RunnerOptions& runner_options) {
  namespace tbb = oneapi::tbb;
  const int threads = std::max(1, runner_options.threads);
  std::vector<std::unique_ptr<Slot>> slots;
  FreeSlots free_slots;
  for (int i = 0; i < threads; ++i) {
    slots.push_back(std::make_unique<Slot>(Pipeline(rig, scene, options)));
    slots.back()->pipeline.want_reconstruction(runner_options.reconstructions);
    if (i > 0) slots.back()->pipeline.share_memory(slots.front()->pipeline);
    free_slots.put(slots.back().get());
  }

  if (runner_options.background) {
    slots.front()->pipeline.set_background(*runner_options.background);
  }

  // An exception from a filter would cancel the loops inside other frames in progress. So the error
  // waits for its turn: the frames before it are delivered, then it is thrown.
  std::size_t frames_done = 0;
  std::exception_ptr first_error;
  std::atomic<bool> failed = false;
  const auto attempt = [&](std::exception_ptr& error, const auto& action) {
    try {
      action();
    } catch (...) {
      error = std::current_exception();
      failed = true;
    }
  };
  const auto read = [&](tbb::flow_control& control) -> Slot* {
    happens_after(&failed);
    happens_after(&source);
    const bool stopped = failed || (runner_options.stop && runner_options.stop->load());
    // There are as many slots as frames in progress, so one is always free here.
    Slot* const slot = stopped ? nullptr : free_slots.take();
    if (!slot) {
      happens_before(&source);
      control.stop();
      return nullptr;
    }
    bool is_there = false;
    slot->error = nullptr;
    attempt(slot->error, [&] { is_there = source.begin(slot->frame); });
    if (is_there) slot->pipeline.take_turn();
    happens_before(slot);
    happens_before(&source);
    if (is_there || slot->error) return slot;
    control.stop();
    return nullptr;
  };
  const auto process = [&](Slot* slot) {
    happens_after(&failed);
    happens_after(slot);
    if (slot->error) return slot;
    attempt(slot->error, [&] {
      source.read_images(slot->frame);
      slot->pipeline.process(slot->frame, slot->result);
      if (!slot->result.report.skipped) sink.write_images(slot->frame, slot->result);
    });
    slot->pipeline.pass_turn();
    happens_before(slot);
    return slot;
  };
  const auto finish = [&](Slot* slot) {
    happens_after(&failed);
    happens_after(slot);
    happens_after(&sink);
    if (!first_error) first_error = slot->error;
    if (!first_error) {
      attempt(first_error, [&] {
        sink.append(slot->frame, slot->result);
        ++frames_done;
        if (runner_options.progress) runner_options.progress(frames_done);
      });
    }
    free_slots.put(slot);
    happens_before(&sink);
  };

  happens_before(&failed);
  tbb::task_arena(threads).execute([&] {
    tbb::parallel_pipeline(
        static_cast<std::size_t>(threads),
        tbb::make_filter<void, Slot*>(tbb::filter_mode::serial_in_order, read) &
            tbb::make_filter<Slot*, Slot*>(tbb::filter_mode::parallel, process) &
            tbb::make_filter<Slot*, void>(tbb::filter_mode::serial_in_order, finish));
  });
  happens_after(&source);
  happens_after(&sink);
  if (first_error) std::rethrow_exception(first_error);
  return frames_done;
}

}  // namespace diminish
