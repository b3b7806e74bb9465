#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "frame_trace.h"
#include "sink/distribution.h"
#include "sink/time_table.h"
#include "start_up.h"

namespace diminish {

/// How fast frames go by, and what each costs.
struct Rate {
  double fps = 0, cpu_ms = 0;
};

/// What was measured.
struct BenchFigures {
  std::size_t frames = 0, left_out = 0, measured = 0;
  StartUp start_up{};
  std::array<Distribution, time_row_count> times_ms;  ///< by row of the table of times
  double throughput_fps = 0;
  Rate reading, run;   ///< from files: without the pipeline, and with it
  std::string device;  ///< the GPU; empty: the CPU
  std::vector<std::pair<std::string, double>> gpu_passes_ms;  ///< medians
  double frame_ms = 0, cpu_frame_ms = 0;                      ///< medians, by turns
  double remembering_frame_ms = 0, forgetful_frame_ms = 0;    ///< medians, by turns
  Distribution memory_ms;                                     ///< how much longer a frame takes
  Distribution allocated_bytes, allocations;                  ///< per frame
  WorkAndSpan cost{};
  std::size_t peak_memory_bytes = 0;
};

/// What was asked for, beside it.
struct BenchSetting {
  std::filesystem::path recording;
  int threads = 1;  ///< frames at a time
  int busy = 0;     ///< threads that compute something else
};

void print(const BenchFigures& figures, int threads);
nlohmann::ordered_json to_json(const BenchFigures& figures, const BenchSetting& setting);

}  // namespace diminish
