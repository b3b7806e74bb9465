#pragma once

#include <cstdint>

#include "diminish/image.h"

namespace diminish {

/// A pixel whose brightness is not known. Known pixels are 1 to 255.
inline constexpr std::uint8_t unknown_grey = 0;
/// The code of such a pixel, and of the outer two rows and columns.
inline constexpr std::uint32_t unknown_census = 0xFF000000U;
/// The most bits in which two codes differ.
inline constexpr int most_census_bits = 32;

/// The census transform (Zabih & Woodfill 1994): for each pixel, which of the 24 around it, in a
/// square of 5 x 5, are darker: row by row, the first in the highest bit. It does not depend on
/// brightness and contrast. In `part` only; the other codes stay as they are. Cost: 1 ns per pixel.
void census(const Image<std::uint8_t>& grey, const Rect& part, Image<std::uint32_t>& codes);

}  // namespace diminish
