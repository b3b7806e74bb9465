#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>

namespace diminish {

bool is_png(std::span<const std::uint8_t> bytes);
bool is_jpeg(std::span<const std::uint8_t> bytes);

/// The number that these bytes, the most significant first, are.
std::uint32_t big_endian(std::span<const std::uint8_t> bytes);

/// The size that a PNG or JPEG says it has, before anything is decoded: a few bytes may claim
/// gigabytes of pixels. Nothing for other formats and where the header is broken.
/// Sources: PNG (ISO/IEC 15948) 11.2.2 IHDR; JPEG (ITU-T T.81) B.2.2 frame header.
std::optional<cv::Size> declared_size(std::span<const std::uint8_t> bytes);

}  // namespace diminish
