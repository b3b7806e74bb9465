#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>

#include "diminish/export.h"
#include "diminish/frame_sink.h"
#include "diminish/frame_source.h"
#include "diminish/options.h"
#include "diminish/scan.h"

namespace diminish {

/// How a run uses the machine.
struct RunnerOptions {
  /// Frames to process at a time, each by one thread. Does not change the output.
  int threads = 1;
  /// Whether the sink uses DiminishedFrame::reconstruction (Pipeline::want_reconstruction).
  bool reconstructions = true;
  /// What was seen of the place before (Pipeline::set_background); null: nothing.
  std::shared_ptr<const Scan> background;
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

/// Keeps what a recording shows of a place: at most 16 of its frames, those that together show
/// most. What the RGB-D cameras see behind the objects to remove is kept apart, for rigs without
/// them. Uses `stop` and `progress`. Throws Error if the rig's poses are not in a world that
/// another recording can share, or if no frame has poses and RGB-D images.
DIMINISH_EXPORT Scan scan_recording(const Recording& recording, const Options& options,
                                    const RunnerOptions& runner_options);

}  // namespace diminish
