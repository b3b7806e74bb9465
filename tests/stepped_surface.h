#pragma once

namespace diminish::testing {

/// Depth in mm: patches of two slanted surfaces, with steps of some 80 cm between them.
inline float stepped_surface(int x, int y) {
  const bool is_near = (x / 23 + y / 17) % 3 == 0;
  return is_near ? 1200 + 3 * static_cast<float>(y)
                 : 2000 + 2 * static_cast<float>(x) - static_cast<float>(y);
}

}  // namespace diminish::testing
