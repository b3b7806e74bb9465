#pragma once

#include <cstdint>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// Makes each pixel of `small` the rounded mean of `scale` x `scale` pixels of `image`. Up to
/// `scale - 1` columns and rows at the right and below are left out; a picture narrower or lower
/// than `scale` becomes one pixel wide or high.
/// scale: 1 to 16. `scratch` is memory to use again.
void shrink_picture(const Image<Bgr>& image, int scale, std::vector<std::uint16_t>& scratch,
                    Image<Bgr>& small);

}  // namespace diminish
