#pragma once

#include "diminish/image.h"

namespace diminish {

/// How far a rectangular neighbourhood reaches from a pixel to each side.
struct Reach {
  int x, y;
};

/// Each value of `result` becomes the largest (dilate) or smallest (erode) of its channel in the
/// pixel's neighbourhood; beyond the border there is nothing. `scratch` is memory to use again;
/// the three images must differ.
void dilate(const Mask& image, const Reach& reach, Mask& scratch, Mask& result);
void erode(const Mask& image, const Reach& reach, Mask& scratch, Mask& result);
void dilate(const Image<Bgr>& image, const Reach& reach, Image<Bgr>& scratch, Image<Bgr>& result);
void erode(const Image<Bgr>& image, const Reach& reach, Image<Bgr>& scratch, Image<Bgr>& result);

}  // namespace diminish
