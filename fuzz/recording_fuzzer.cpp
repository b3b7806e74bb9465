#include <cstddef>
#include <cstdint>

#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "fuzzed_folder.h"
#include "small_cameras.h"

/// Any folder is a recording whose frames can be processed, or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace diminish;
  static FuzzedFolder folder;
  folder.fill(data, size);
  try {
    const Recording recording = load_recording(folder.path());
    if (!has_small_cameras(recording.rig)) return 0;
    const Options options;
    const auto source = open_recording(recording, options);
    Pipeline pipeline(recording.rig, recording.scene, options);
    FrameSet frame;
    DiminishedFrame result;
    constexpr int most_frames = 3;
    for (int i = 0; i < most_frames && source->next(frame); ++i) pipeline.process(frame, result);
  } catch (const Error&) {
  }
  return 0;
}
