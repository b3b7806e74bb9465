// A recording in, pictures out: the library on one page.
//   remove_objects RECORDING
#include <cstdio>
#include <exception>
#include <string>

#include "diminish/diminish.h"

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: remove_objects RECORDING\n");
    return 2;
  }
  const diminish::Recording recording = diminish::load_recording(argv[1]);
  const diminish::Options options;
  const auto source = diminish::open_recording(recording, options);
  diminish::Pipeline pipeline(recording.rig, recording.scene, options);
  diminish::FrameSet frame;
  diminish::DiminishedFrame result;
  while (source->next(frame)) {
    pipeline.process(frame, result);
    std::printf("%s: %zu pixels replaced, of which %zu were seen\n", result.name.c_str(),
                result.report.mask_pixels, result.report.valid_pixels);
    for (const std::string& message : result.report.messages) std::puts(message.c_str());
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
