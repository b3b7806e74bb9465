#pragma once

#include <cstdint>
#include <random>

#include "diminish/image.h"

namespace diminish::testing {

/// Every level in two channels, the extremes in the third; always the same picture of a size.
inline Image<Bgr> noise(int width, int height) {
  Image<Bgr> image(width, height);
  std::mt19937 random(5);
  for (Bgr& color : image) {
    const std::uint_fast32_t value = random();
    color = {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8),
             static_cast<std::uint8_t>(value >> 16 & 1 ? 255 : 0)};
  }
  return image;
}

}  // namespace diminish::testing
