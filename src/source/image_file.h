#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

// All of these throw Error with the reason only. The caller knows the image's name.

/// Reads the bytes of an image file.
std::vector<std::uint8_t> read_bytes(const std::filesystem::path& file);

/// Decodes a colour image (8-bit BGR, whatever it was) or a depth image (as it is). Orientation
/// tags are ignored: images are as the sensor made them.
template <class Pixel>
cv::Mat decode(const std::vector<std::uint8_t>& bytes);

/// Throws Error if an image does not have the camera's size or is not of `Pixel`s.
template <class Pixel>
void expect_format(const cv::Mat& image, const Intrinsics& camera);

/// Reads an object's mask: 255 where any channel of a pixel except alpha is not 0.
void read_mask(const std::filesystem::path& file, const Intrinsics& camera, Mask& mask);

}  // namespace diminish
