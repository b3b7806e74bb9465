#pragma once

#include <string>
#include <vector>

namespace diminish {

/// The GPU's time in one pass of a frame.
struct GpuPass {
  const char* name;     ///< "vertices"
  double milliseconds;  ///< on the GPU's own clock
};

/// A frame's drawing (Reconstructor).
struct DrawingReport {
  double milliseconds = 0;      ///< from call to return
  std::string device;           ///< the GPU driver's name; empty: the CPU
  std::vector<GpuPass> passes;  ///< in order; empty: the CPU
};

}  // namespace diminish
