#pragma once

#include <cstdint>

#include "diminish/image.h"
#include "reconstruct/cell_rasterizer.h"

namespace diminish {

/// The colours of `count` neighbouring samples, looked up in `texture` as sample_bilinear does:
/// alpha 255, and z; both 0 where the sample is empty or `wanted` is 0.
/// wanted: null if all are.
void look_up(const SurfaceBuffer::Sample* samples, const std::uint8_t* wanted, int count,
             const Image<Bgr>& texture, Bgra* colors, float* depth_m);

}  // namespace diminish
