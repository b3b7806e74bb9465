#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include "diminish/export.h"
#include "diminish/frame_sink.h"
#include "diminish/frame_source.h"
#include "diminish/options.h"

namespace diminish {

/// How a run uses the machine.
struct RunnerOptions {
  /// Frames in work at a time, each by one thread: those of a oneTBB arena that `run` makes for
  /// itself, the calling thread being one of them. The output does not depend on it.
  int threads = 1;
  /// Whether the sink looks at DiminishedFrame::reconstruction (Pipeline::want_reconstruction).
  bool reconstructions = true;
  /// Set to true from anywhere (a signal handler) to end the run after the frames in work.
  const std::atomic<bool>* stop = nullptr;
  /// Called after each frame, in order.
  std::function<void(std::size_t frames_done)> progress;
};

/// Takes every frame from `source` through the pipeline to `sink`; the number of frames done.
/// Throws what source and sink throw, once the frames before are delivered and those in work are
/// over, and Error on a configuration that cannot work.
DIMINISH_EXPORT std::size_t run(FrameSource& source, const Rig& rig, const Scene& scene,
                                const Options& options, FrameSink& sink,
                                const RunnerOptions& runner_options);

}  // namespace diminish
