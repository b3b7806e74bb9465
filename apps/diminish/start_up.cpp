#include "start_up.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <list>

namespace diminish {
namespace {

struct PipelineWithResult {
  PipelineWithResult(const Recording& input, const Options& options)
      : pipeline(input.rig, input.scene, options) {
    pipeline.want_reconstruction(false);
  }

  Pipeline pipeline;
  DiminishedFrame result;
};

/// Of this process.
std::size_t resident_bytes() {
  std::size_t all_pages = 0;
  std::size_t resident_pages = 0;
  std::ifstream("/proc/self/statm") >> all_pages >> resident_pages;
  return resident_pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

StartUp measure_start_up(const Recording& input, const std::vector<FrameSet>& frames,
                         const Options& options) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  PipelineWithResult first(input, options);
  first.pipeline.process(frames.front(), first.result);
  StartUp start_up{};
  start_up.first_frame_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();

  constexpr std::size_t further = 4;
  constexpr std::size_t most_frames = 20;
  const std::size_t before = resident_bytes();
  std::list<PipelineWithResult> others;
  for (std::size_t i = 0; i < further; ++i) {
    PipelineWithResult& other = others.emplace_back(input, options);
    other.pipeline.share_memory(first.pipeline);
    for (std::size_t k = 0; k < std::min(frames.size(), most_frames); ++k) {
      other.pipeline.process(frames[k], other.result);
    }
  }
  const std::size_t after = resident_bytes();
  start_up.pipeline_bytes = (after - std::min(before, after)) / further;
  return start_up;
}

}  // namespace diminish
