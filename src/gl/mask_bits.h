#pragma once

#include <cstdint>

#include "diminish/image.h"

namespace diminish::gl {

/// Words of 32 pixels that a row of a mask takes.
inline int words_of_row(int width) {
  return (width + 31) / 32;
}

/// A mask as a bit a pixel: rows of whole words, the leftmost pixel in a word's lowest bit.
void pack_bits(const Mask& mask, std::uint32_t* words);
/// Writes 0 and 255; the mask has its size.
void unpack_bits(const std::uint32_t* words, Mask& mask);

}  // namespace diminish::gl
