#pragma once

#include <cstdint>

#include "diminish/image.h"

namespace diminish::gl {

// Masks with one bit per pixel: words of 32 pixels of a row, the leftmost in the lowest bit.

/// A part of a mask, in rows and words.
struct BitWindow {
  int first_word = 0, first_row = 0;
  int words = 0, rows = 0;

  BitWindow() = default;
  /// The whole words that contain a part of the picture.
  explicit BitWindow(const Rect& part);
  int size() const { return words * rows; }
};

/// Row by row.
void pack_bits(const Mask& mask, const BitWindow& window, std::uint32_t* words);
/// Writes 0 and 255 in the window.
void unpack_bits(const std::uint32_t* words, const BitWindow& window, Mask& mask);

}  // namespace diminish::gl
