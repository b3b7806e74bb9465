#pragma once

#include <string>
#include <vector>

namespace diminish {

/// What the GPU did in one pass of a frame.
struct GpuPass {
  const char* name;     ///< "vertices"
  double milliseconds;  ///< of the GPU's own clock
};

/// A frame's drawing (Reconstructor).
struct DrawingReport {
  double milliseconds = 0;      ///< from its call to its return
  std::string device;           ///< the GPU, by its driver's name; empty: the CPU
  std::vector<GpuPass> passes;  ///< in their order; empty: the CPU
};

}  // namespace diminish
