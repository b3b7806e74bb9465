#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "diminish/image.h"

namespace diminish::testing {

/// The largest difference of two colours' channels, in levels.
template <class Pixel>
int difference(const Pixel& a, const Pixel& b) {
  return std::max({std::abs(a.b - b.b), std::abs(a.g - b.g), std::abs(a.r - b.r)});
}

/// Of the channels of the pixels where `mask` is not 0; squared levels.
inline double mean_squared_difference(const Image<Bgr>& a, const Image<Bgr>& b, const Mask& mask) {
  double squares = 0;
  double count = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask.data()[i] == 0) continue;
    const Bgr& p = a.data()[i];
    const Bgr& q = b.data()[i];
    squares += std::pow(p.b - q.b, 2) + std::pow(p.g - q.g, 2) + std::pow(p.r - q.r, 2);
    count += 3;
  }
  return squares / count;
}

/// Peak signal-to-noise ratio where `mask` is not 0, dB.
inline double psnr_db(const Image<Bgr>& picture, const Image<Bgr>& truth, const Mask& mask) {
  return 10 * std::log10(255 * 255 / mean_squared_difference(picture, truth, mask));
}

}  // namespace diminish::testing
