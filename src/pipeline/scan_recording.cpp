#include "diminish/error.h"
#include "diminish/pipeline.h"
#include "diminish/runner.h"
#include "memory/scan_frames.h"

namespace diminish {
namespace {

/// The longest that may be asked for: nothing ages during a scan.
constexpr double no_age_s = 1e6;

Scan remember(FrameSource& source, const Recording& recording, Options options,
              const RunnerOptions& runner_options) {
  options.memory = "on";
  options.memory_max_age_s = no_age_s;
  options.inpaint = "none";
  Pipeline pipeline(recording.rig, recording.scene, options);
  pipeline.want_reconstruction(false);
  FrameSet frame;
  DiminishedFrame result;
  std::size_t done = 0;
  while (!(runner_options.stop && *runner_options.stop) && source.next(frame)) {
    pipeline.process(frame, result);
    if (runner_options.progress) runner_options.progress(++done);
  }
  return pipeline.scan();
}

/// Adds what the RGB-D cameras see behind the objects.
void look_behind(FrameSource& source, const Recording& recording, Options options, Scan& scan) {
  options.memory = "off";
  Pipeline pipeline(recording.rig, recording.scene, options);
  FrameSet frame;
  DiminishedFrame result;
  add_behind(
      [&](std::size_t i) -> const DiminishedFrame& {
        do {
          if (!source.begin(frame)) throw Error("the recording has changed during the scan");
        } while (frame.stamp_s < scan.frames[i].frame.stamp_s);
        source.read_images(frame);
        pipeline.process(frame, result);
        return result;
      },
      scan);
}

}  // namespace

Scan scan_recording(const Recording& recording, const Options& options,
                    const RunnerOptions& runner_options) {
  expect_world(recording.rig);
  const auto source = open_recording(recording, options);
  Scan scan = remember(*source, recording, options, runner_options);
  if (scan.frames.empty()) {
    throw Error(Error::input, recording.folder.string() +
                                  ": nothing was learnt: no frame has poses and RGB-D images");
  }
  look_behind(*open_recording(recording, options), recording, options, scan);
  return scan;
}

}  // namespace diminish
