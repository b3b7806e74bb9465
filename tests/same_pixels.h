#pragma once

#include <algorithm>

#include "diminish/input_image.h"

namespace diminish::testing {

/// Whether two cameras' images have the same size and the same pixels.
template <class Pixel>
bool same_pixels(const InputImage<Pixel>& a, const InputImage<Pixel>& b) {
  if (a.bounds() != b.bounds()) return false;
  for (int y = 0; y < a.height(); ++y) {
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) return false;
  }
  return true;
}

}  // namespace diminish::testing
