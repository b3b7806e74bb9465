#pragma once

#include <cstdint>

#include "diminish/image.h"
#include "reconstruct/cell_rasterizer.h"

namespace diminish {

/// The colours of a row of a surface, looked up in `texture` as sample_bilinear does: alpha 255,
/// and z; both 0 where the surface is empty or `wanted` is 0. wanted: null if all are.
void look_up_row(const SurfaceBuffer& surface, int y, const std::uint8_t* wanted,
                 const Image<Bgr>& texture, Bgra* colors, float* depth_m);

}  // namespace diminish
