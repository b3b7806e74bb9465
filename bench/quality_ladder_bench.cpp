// What each level of --budget saves.   diminish_ladder_bench RECORDING...
// Fails if a level is not faster than the one above it, on all recordings together.
#include <cmath>
#include <cstdio>
#include <exception>
#include <vector>

#include "core/robust.h"
#include "diminish/diminish.h"
#include "live/quality_ladder.h"

namespace diminish {
namespace {

constexpr std::size_t levels = QualityLadder::last_level + 1;

/// A recording's frames at all levels in turn, so that a machine whose speed drifts slows all. By
/// level the median time, and the median of how much faster a frame is than one level above it.
struct LevelTimes {
  double ms[levels];
  double ratios[levels];
};

LevelTimes measure(const Recording& recording, double seconds) {
  Options options;
  options.whole_view = true;
  options.remove_shadows = true;
  std::vector<FrameSet> frames;
  const auto source = open_recording(recording, options);
  for (FrameSet frame; source->next(frame);) frames.push_back(frame);

  std::vector<Pipeline> pipelines;
  for (std::size_t level = 0; level < levels; ++level) {
    const Options simpler = QualityLadder::simplified(options, static_cast<int>(level));
    pipelines.emplace_back(recording.rig, recording.scene, simpler).want_reconstruction(false);
  }
  DiminishedFrame result;
  std::vector<double> times[levels];
  std::vector<double> ratios[levels];
  const double start_s = monotonic_now_s();
  for (std::size_t i = 0; i < 20 || monotonic_now_s() < start_s + seconds; ++i) {
    for (std::size_t level = 0; level < levels; ++level) {
      const double before_s = monotonic_now_s();
      pipelines[level].process(frames[i % frames.size()], result);
      const double ms = 1000 * (monotonic_now_s() - before_s);
      if (i == 0) continue;  // lets memory grow to its size
      times[level].push_back(ms);
      ratios[level].push_back(level > 0 ? times[level - 1].back() / ms : 1);
    }
  }
  LevelTimes medians{};
  for (std::size_t level = 0; level < levels; ++level) {
    medians.ms[level] = median(times[level]);
    medians.ratios[level] = median(ratios[level]);
  }
  return medians;
}

bool every_level_saves_time(const std::vector<LevelTimes>& recordings) {
  bool all_do = true;
  for (std::size_t level = 1; level < levels; ++level) {
    double logarithms = 0;
    for (const LevelTimes& times : recordings) logarithms += std::log(times.ratios[level]);
    const double ratio = std::exp(logarithms / static_cast<double>(recordings.size()));
    std::printf("level %zu: %.3f times as fast as level %zu%s\n", level, ratio, level - 1,
                ratio > 1 ? "" : "   NOT FASTER");
    all_do = all_do && ratio > 1;
  }
  return all_do;
}

}  // namespace
}  // namespace diminish

int main(int argc, char** argv) try {
  using namespace diminish;
  if (argc < 2) {
    std::fprintf(stderr, "usage: diminish_ladder_bench RECORDING...\n");
    return 2;
  }
  std::vector<LevelTimes> recordings;
  for (int i = 1; i < argc; ++i) {
    constexpr double seconds = 10;
    recordings.push_back(measure(load_recording(argv[i]), seconds));
    std::printf("%s:", argv[i]);
    for (const double ms : recordings.back().ms) std::printf(" %.1f", ms);
    std::printf(" ms\n");
  }
  return every_level_saves_time(recordings) ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
