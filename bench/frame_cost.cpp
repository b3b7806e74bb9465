// What each stage of a frame costs in instructions, for callgrind to count (times on shared
// machines say less), and how much memory it allocates.   diminish_frame_cost RECORDING [MEMORY]
// (by scripts/check-baselines, under valgrind; MEMORY: as --memory)
//
// Callgrind writes what it counted at each reading of the clock. Stages read it when they begin and
// end. The clock here is no clock: its n-th reading in a frame is 2^n ns, so that a stage's time
// has bit n set if the stretch from reading n to the next is the stage's.
#include <hwy/targets.h>
#include <oneapi/tbb/global_control.h>
#include <valgrind/callgrind.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <vector>

#include "allocations.h"
#include "diminish/diminish.h"

namespace {

bool is_counting = false;
int readings = 0;

}  // namespace

/// Takes the standard library's place, in the libraries, too.
std::chrono::steady_clock::time_point std::chrono::steady_clock::now() noexcept {
  if (is_counting) CALLGRIND_DUMP_STATS;
  return time_point(duration(std::int64_t{1} << std::min(readings++, 62)));
}

namespace diminish {
namespace {

/// The same instructions on every machine: valgrind knows none beyond these.
const char* use_common_vectors() {
  hwy::DisableTargets(HWY_AVX2 - 1);
  const std::int64_t supported = hwy::SupportedTargets();
  return hwy::TargetName(supported & -supported);
}

/// The stage that a stretch belongs to; of stages within each other the innermost, if any.
const char* stage_of(int stretch, const StageTimes& milliseconds) {
  const char* name = "between";
  int shortest = 64;
  for (std::size_t stage = 0; stage < stage_count; ++stage) {
    const auto stretches = static_cast<std::uint64_t>(std::llround(1e6 * milliseconds[stage]));
    const int length = std::popcount(stretches);
    if ((stretches >> stretch & 1) == 0 || length >= shortest) continue;
    shortest = length;
    name = stage_names[stage];
  }
  return name;
}

/// Prints the vector instructions and the number of frames, then the stage of each of callgrind's
/// dumps, then the bytes that were allocated (-1: not counted).
void count(const Recording& recording, const Options& options) {
  const auto source = open_recording(recording, options);
  std::vector<FrameSet> frames;
  for (FrameSet frame; source->next(frame);) frames.push_back(frame);
  std::printf("%s:%zu\n", use_common_vectors(), frames.size());

  Pipeline pipeline(recording.rig, recording.scene, options);
  pipeline.want_reconstruction(false);
  DiminishedFrame result;
  for (int lap = 0; lap < 2; ++lap) {  // memory grows to its size
    for (const FrameSet& frame : frames) pipeline.process(frame, result);
  }
  long long allocated = count_allocations ? 0 : -1;
  CALLGRIND_START_INSTRUMENTATION;
  for (const FrameSet& frame : frames) {
    readings = 0;
    is_counting = true;
    const std::size_t before = count_allocations ? count_allocations().bytes : 0;
    CALLGRIND_ZERO_STATS;
    pipeline.process(frame, result);
    CALLGRIND_DUMP_STATS;
    is_counting = false;
    if (count_allocations) allocated += static_cast<long long>(count_allocations().bytes - before);
    if (readings > 50) throw std::runtime_error("more readings of the clock than a time has bits");
    std::puts("between");
    for (int i = 0; i < readings; ++i) std::puts(stage_of(i, result.report.milliseconds));
  }
  CALLGRIND_STOP_INSTRUMENTATION;
  std::printf("%lld\n", allocated);
}

}  // namespace
}  // namespace diminish

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: diminish_frame_cost RECORDING [MEMORY]\n");
    return 2;
  }
  diminish::Options options;
  if (argc > 2) options.memory = argv[2];
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism,
                                               1);
  cv::setNumThreads(1);
  diminish::count(diminish::load_recording(argv[1]), options);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
