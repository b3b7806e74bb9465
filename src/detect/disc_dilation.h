#pragma once

#include "diminish/image.h"

namespace diminish {

/// Sets every pixel of `mask` at most `radius` pixels (Euclidean, between centres) from a non-zero
/// pixel to 255, and the others to 0. `scratch` is memory to use again.
void dilate_by_disc(Mask& mask, int radius, Mask& scratch);

/// Fills gaps and holes that a disc of `radius` pixels does not fit in: dilation, then erosion.
void close_by_disc(Mask& mask, int radius, Mask& scratch);

}  // namespace diminish
