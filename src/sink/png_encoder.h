#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// The bytes of a PNG of an 8-bit picture: grey, BGR or BGRA. With a palette of up to 256 colours,
/// the pixels of a picture of one channel are indices into it. Made to be fast: half of libpng's
/// time or less, about as many bytes.
std::vector<std::uint8_t> encode_png(const cv::Mat& picture, const std::vector<Bgr>& palette = {});

}  // namespace diminish
