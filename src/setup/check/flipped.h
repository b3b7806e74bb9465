#pragma once

#include <opencv2/core.hpp>

#include "core/mat.h"
#include "diminish/image.h"

namespace diminish {

/// Mirrors left to right.
template <class Pixel>
Image<Pixel> flipped(const ImageView<Pixel>& image) {
  Image<Pixel> result(image.width(), image.height());
  cv::Mat mat = as_mat(result);
  cv::flip(as_mat(image), mat, 1);
  return result;
}

}  // namespace diminish
