#include "diminish/runner.h"

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "core/shared_tasks.h"
#include "core/thread_name.h"
#include "core/turns.h"
#include "diminish/pipeline.h"

namespace diminish {
namespace {

/// A thread's frame, and the pipeline that works on it.
struct Lane {
  explicit Lane(Pipeline pipeline_) : pipeline(std::move(pipeline_)) {}

  Pipeline pipeline;
  FrameSet frame;
  DiminishedFrame result;
  Turn finishing;
  std::exception_ptr error;  ///< why the frame could not be done
};

/// Takes frames from the source to the sink, in lanes that each have a thread.
class Run {
 public:
  Run(FrameSource& source, FrameSink& sink, const RunnerOptions& options, int threads)
      : source_(source), sink_(sink), options_(options), budget_(threads) {}

  /// One lane's thread. When lanes end, helpers take their place in the frames of others.
  void work(Lane& lane) {
    const ThreadBudget::Use use(budget_);
    while (begin(lane)) {
      process(lane);
      lane.finishing.wait(finishing_);
      finish(lane);
      lane.finishing.end();
    }
  }

  /// Throws what went wrong first.
  std::size_t frames_done() const {
    if (first_error_) std::rethrow_exception(first_error_);
    return frames_done_;
  }

 private:
  // The frames before one that failed are delivered, then its error is thrown.
  template <class Action>
  void attempt(std::exception_ptr& error, const Action& action) {
    try {
      action();
    } catch (...) {
      error = std::current_exception();
      failed_ = true;
    }
  }

  /// False if there are no more frames.
  bool begin(Lane& lane) {
    const std::lock_guard lock(intake_);
    if (ended_ || failed_ || (options_.stop && options_.stop->load())) return false;
    lane.error = nullptr;
    bool is_there = false;
    attempt(lane.error, [&] { is_there = source_.begin(lane.frame); });
    ended_ = !is_there;
    if (is_there) lane.pipeline.take_turn();
    if (is_there || lane.error) lane.finishing.take(finishing_);
    return is_there || lane.error;
  }

  void process(Lane& lane) {
    if (lane.error) return;
    attempt(lane.error, [&] {
      source_.read_images(lane.frame);
      lane.pipeline.process(lane.frame, lane.result);
      if (!lane.result.report.skipped) sink_.write_images(lane.frame, lane.result);
    });
    lane.pipeline.pass_turn();
  }

  void finish(const Lane& lane) {
    if (!first_error_) first_error_ = lane.error;
    if (first_error_) return;
    attempt(first_error_, [&] {
      sink_.append(lane.frame, lane.result);
      ++frames_done_;
      if (options_.progress) options_.progress(frames_done_);
    });
  }

  FrameSource& source_;
  FrameSink& sink_;
  const RunnerOptions& options_;
  ThreadBudget budget_;
  std::atomic<bool> failed_ = false;
  std::mutex intake_;  ///< guards the source's order, and the next member
  bool ended_ = false;
  Turns finishing_;  ///< guards what follows
  std::size_t frames_done_ = 0;
  std::exception_ptr first_error_;
};

}  // namespace

std::size_t run(FrameSource& source, const Rig& rig, const Scene& scene, const Options& options,
                FrameSink& sink, const RunnerOptions& runner_options) {
  const int threads = std::max(1, runner_options.threads);
  std::vector<std::unique_ptr<Lane>> lanes;
  for (int i = 0; i < threads; ++i) {
    lanes.push_back(std::make_unique<Lane>(Pipeline(rig, scene, options)));
    lanes.back()->pipeline.want_reconstruction(runner_options.reconstructions);
    if (i > 0) lanes.back()->pipeline.share_memory(lanes.front()->pipeline);
  }
  if (runner_options.background) {
    lanes.front()->pipeline.set_background(*runner_options.background);
  }

  Run run(source, sink, runner_options, threads);
  {
    std::vector<std::jthread> others;
    try {
      for (std::size_t i = 1; i < lanes.size(); ++i) {
        others.emplace_back([&run, &lane = *lanes[i]] {
          name_this_thread("frames");
          run.work(lane);
        });
      }
    } catch (const std::system_error&) {
      // Fewer frames at a time.
    }
    run.work(*lanes.front());
  }
  return run.frames_done();
}

}  // namespace diminish
