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
  /// Frames to process at a time, each by one thread. Does not change the output.
  int threads = 1;
  /// Whether the sink uses DiminishedFrame::reconstruction (Pipeline::want_reconstruction).
  bool reconstructions = true;
  /// Set it to true from anywhere (such as a signal handler) to end the run after the current
  /// frames.
  const std::atomic<bool>* stop = nullptr;
  /// Called after each frame, in order.
  std::function<void(std::size_t frames_done)> progress;
};

/// Takes every frame from `source` through the pipeline to `sink`. Returns the number of frames
/// done. Throws what source and sink throw, after the frames before are delivered and the current
/// ones are done, and Error on a configuration that cannot work.
DIMINISH_EXPORT std::size_t run(FrameSource& source, const Rig& rig, const Scene& scene,
                                const Options& options, FrameSink& sink,
                                const RunnerOptions& runner_options);

}  // namespace diminish
