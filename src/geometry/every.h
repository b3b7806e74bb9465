#pragma once

#include "diminish/intrinsics.h"

namespace diminish {

/// Of the image of every `step`-th pixel in both directions, from the first one on.
inline Intrinsics every(int step, Intrinsics image) {
  image.width = (image.width - 1) / step + 1;
  image.height = (image.height - 1) / step + 1;
  image.fx /= step;
  image.fy /= step;
  image.cx /= step;
  image.cy /= step;
  return image;
}

}  // namespace diminish
