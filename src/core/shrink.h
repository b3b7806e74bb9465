#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "diminish/image.h"

namespace diminish {

// Pictures made smaller by a whole factor: from all colours of each square (`shrink`), or from as
// few pixels as finding markers needs (`shrink_green`) or telling frames apart (`shrink_outside`).
// ShrunkPicture computes pixels on demand.

/// The size that `shrink` makes of a picture. Up to `scale - 1` columns and rows at the right and
/// below are left out; a picture narrower or lower than `scale` becomes one pixel wide or high.
inline Rect shrunk_bounds(ImageView<Bgr> image, int scale) {
  return {0, 0, std::max(1, image.width() / scale), std::max(1, image.height() / scale)};
}

/// Makes each pixel of `small` the rounded mean of `scale` x `scale` pixels of `image`, in a part
/// of `shrunk_bounds`. scale: 1 to 16. `scratch` is memory to reuse.
void shrink(ImageView<Bgr> image, int scale, const Rect& part, std::vector<std::uint16_t>& scratch,
            Image<Bgr>& small);

/// The picture's brightness at a quarter of the resolution: each pixel is the rounded mean of 4x2
/// pixels' green channel (the other channels add little), from the square's two middle rows.
/// Enough to see a marker, and little memory to read.
inline constexpr int green_shrinkage = 4;
void shrink_green(ImageView<Bgr> image, Image<std::uint8_t>& small);

/// A coarse grey picture, for comparing frames: each pixel is the mean of b, g, g and r of four
/// pixels of a square, at least 1; 0 where the mask is set in the square's middle. scale: the
/// square's side. Both images have the same size.
void shrink_outside(ImageView<Bgr> image, const Mask& mask, int scale, Image<std::uint8_t>& small);

}  // namespace diminish
