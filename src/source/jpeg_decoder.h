#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>

namespace diminish {

/// Decodes a JPEG to 8-bit BGR, without a word on stderr. Empty where its colours are not a
/// camera's (CMYK). Throws Error with the reason if the decoder notices that coded pixels are
/// damaged, where cv::imdecode goes on with what it has.
cv::Mat decode_jpeg(std::span<const std::uint8_t> bytes);

}  // namespace diminish
