#pragma once

#include <cmath>

namespace diminish {

/// Depths of one thing, from pixel to pixel, differ by less.
inline constexpr float thing_step_m = 0.05F;

inline bool may_be_one_thing(float a_m, float b_m) {
  return std::abs(a_m - b_m) < thing_step_m;
}

}  // namespace diminish
