#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>

namespace diminish {

bool is_png(std::span<const std::uint8_t> bytes);
bool is_jpeg(std::span<const std::uint8_t> bytes);

/// The number that these bytes, the most significant first, are.
std::uint32_t big_endian(std::span<const std::uint8_t> bytes);

/// What a PGM or PPM file with binary pixels says.
struct PnmHeader {
  std::uint32_t width = 0, height = 0;
  std::size_t bytes_a_pixel = 0;
  std::size_t pixels_at = 0;  ///< offset, bytes
};
std::optional<PnmHeader> pnm_header(std::span<const std::uint8_t> bytes);

/// The size that a PNG, JPEG, BMP, TIFF, WebP, PGM or PPM says it has, before anything is decoded:
/// a few bytes may claim gigabytes of pixels. Nothing for other formats and where the header is
/// broken. Sources: PNG (ISO/IEC 15948) 11.2.2 IHDR; JPEG (ITU-T T.81) B.2.2 frame header;
/// Microsoft, BITMAPINFOHEADER; TIFF 6.0, section 2; Google, WebP Container Specification; Netpbm,
/// pgm(5).
std::optional<cv::Size> declared_size(std::span<const std::uint8_t> bytes);

/// How long a BMP, PGM or PPM must be to have all pixels that it says; 0 for other formats.
std::size_t least_bytes(std::span<const std::uint8_t> bytes);

}  // namespace diminish
