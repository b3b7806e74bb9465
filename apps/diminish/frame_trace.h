#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "diminish/diminish.h"

namespace diminish {

/// A pipeline that has made all frames once, so that its memory, and `result`'s, has its final
/// size.
Pipeline warm_pipeline(const Recording& input, const std::vector<FrameSet>& frames,
                       const Options& options, DiminishedFrame& result);

/// Of a frame, medians.
struct WorkAndSpan {
  double work_ms;  ///< on one thread
  double span_ms;  ///< the longest chain of parts that wait for one another: any number of threads
  int regions;     ///< in which threads share tasks
  int tasks;
  std::vector<std::pair<const char*, double>> chain_ms;  ///< the longest chain by stage
};

/// Measured on one thread, so that nothing else takes part, by that thread's own clock.
WorkAndSpan measure_work_and_span(const Recording& input, const std::vector<FrameSet>& frames,
                                  const Options& options);

/// Writes who did what, when, in up to 20 of the frames, as a Chrome trace (JSON), which Perfetto
/// shows. Throws Error if the file cannot be written.
void write_trace(const Recording& input, const std::vector<FrameSet>& frames,
                 const Options& options, const std::filesystem::path& file);

}  // namespace diminish
