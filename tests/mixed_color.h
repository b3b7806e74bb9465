#pragma once

#include "diminish/reconstruction.h"

namespace diminish::testing {

/// The colours of both cameras that show a pixel, mixed by their shares, as if both were the colour
/// camera's. Rounded towards the first.
inline Bgra mixed_color(const Reconstruction& reconstruction, int x, int y) {
  const Bgra& a = reconstruction.color(x, y);
  const SecondView& second = reconstruction.second;
  if (second.share.empty()) return a;
  const Bgra& b = second.color(x, y);
  const auto mix = [&](int first, int other) {
    return static_cast<std::uint8_t>(first + (other - first) * second.share(x, y) / 255);
  };
  return {mix(a.b, b.b), mix(a.g, b.g), mix(a.r, b.r), a.a};
}

}  // namespace diminish::testing
