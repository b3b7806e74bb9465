#pragma once

#include "diminish/image.h"

namespace diminish {

/// How far a rectangular neighbourhood extends from a pixel to each side.
struct Reach {
  int x, y;
};

/// Each value of `result` becomes the largest (dilate) or smallest (erode) value of its channel in
/// the pixel's neighbourhood, without anything beyond the border. `scratch` is memory to reuse; the
/// three images must differ.
void dilate(const Mask& image, const Reach& reach, Mask& scratch, Mask& result);
void erode(const Mask& image, const Reach& reach, Mask& scratch, Mask& result);
void dilate(const Image<Bgr>& image, const Reach& reach, Image<Bgr>& scratch, Image<Bgr>& result);
void erode(const Image<Bgr>& image, const Reach& reach, Image<Bgr>& scratch, Image<Bgr>& result);

}  // namespace diminish
