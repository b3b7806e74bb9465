#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "diminish/image.h"

namespace diminish {

inline Eigen::Array3f to_channels(const Bgr& color) {
  return {static_cast<float>(color.b), static_cast<float>(color.g), static_cast<float>(color.r)};
}

/// Rounds to the nearest level, clamped.
inline Bgr to_color(const Eigen::Array3f& channels) {
  const auto level = [&](int channel) {
    return static_cast<std::uint8_t>(std::lrint(std::clamp(channels[channel], 0.F, 255.F)));
  };
  return {level(0), level(1), level(2)};
}

}  // namespace diminish
