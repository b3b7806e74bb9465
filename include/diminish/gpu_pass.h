#pragma once

namespace diminish {

/// What the GPU did in one pass of a frame.
struct GpuPass {
  const char* name;     ///< "vertices"
  double milliseconds;  ///< of the GPU's own clock
};

}  // namespace diminish
