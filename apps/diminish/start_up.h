#pragma once

#include <cstddef>
#include <vector>

#include "diminish/diminish.h"

namespace diminish {

/// What it takes to begin.
struct StartUp {
  double first_frame_ms;  ///< from before the pipeline is made until its first frame is done
  /// Of the machine's memory, for each further pipeline with its result; those of one rig share
  /// tables.
  std::size_t pipeline_bytes;
};

/// Measure it first: what pipelines share, and memory that is free again, makes it less.
StartUp measure_start_up(const Recording& input, const std::vector<FrameSet>& frames,
                         const Options& options);

}  // namespace diminish
