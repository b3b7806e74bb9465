#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "diminish/image.h"

namespace diminish {

/// A row of gains: what is lost of a label's light is multiplied by them.
struct LightGains {
  static constexpr int cell_px = 8;
  static constexpr int one = 64;  ///< gains are in fixed point
  /// Of each cell's middle, in three channels, from 0 on; times the largest level they fit 16 bits.
  /// Between middles they are interpolated.
  std::span<const Eigen::Array4i> by_cell;
  std::uint8_t label;      ///< what has another keeps its light
  std::uint8_t most_dark;  ///< no pixel loses more light, whatever its label
};

/// Scales the light of `count` pixels, from the first cell's first one on. Cost: 1 ns for a pixel
/// that is not fully lit.
void scale_light(const LightGains& gains, const std::uint8_t* labels, int count, Bgr* light);

}  // namespace diminish
