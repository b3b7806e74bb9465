#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// The size that `shrink_picture` makes of a picture. Up to `scale - 1` columns and rows at the
/// right and below are left out; a picture narrower or lower than `scale` becomes one pixel wide or
/// high.
inline Rect shrunk_bounds(const Image<Bgr>& image, int scale) {
  return {0, 0, std::max(1, image.width() / scale), std::max(1, image.height() / scale)};
}

/// Makes each pixel of `small` the rounded mean of `scale` x `scale` pixels of `image`, in a part
/// of `shrunk_bounds`.
/// scale: 1 to 16. `scratch` is memory to use again.
void shrink_picture(const Image<Bgr>& image, int scale, const Rect& part,
                    std::vector<std::uint16_t>& scratch, Image<Bgr>& small);

}  // namespace diminish
