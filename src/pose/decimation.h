#pragma once

#include <cstdint>

#include "diminish/image.h"

namespace diminish {

/// The picture's brightness at a quarter of the resolution: each pixel is the mean of 4x2 pixels.
/// Enough to see a marker, and little memory to read.
inline constexpr int decimation = 4;
void decimate(const Image<Bgr>& image, Image<std::uint8_t>& small);

}  // namespace diminish
