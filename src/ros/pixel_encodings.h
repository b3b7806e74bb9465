#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "diminish/image.h"
#include "ros/messages.h"

namespace diminish::ros {

/// The unit of ROS's integer depth (REP 118).
inline constexpr double millimetre_m = 0.001;

/// Depth in units; 0 for what is not a distance, or above 16 bits.
inline std::uint16_t depth_value(float metres, float unit_m) {
  const float value = metres / unit_m + 0.5F;
  return value >= 1 && value < 65536 ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
}

/// Changes the unit of depth values. Does nothing where the units are the same.
void rescale_depth(double from_unit_m, double to_unit_m, Image<std::uint16_t>& depth);

/// Throws Error (input) for a size that no camera has: 0, or beyond 16384 or 67 million pixels.
void expect_camera_size(std::uint32_t width, std::uint32_t height);
/// The same for what a compressed image says of itself, before it is decoded.
void expect_declared_size(std::span<const std::uint8_t> image);

/// Whether an encoding is one of depth: 16UC1, mono16 or 32FC1.
bool is_depth_encoding(const std::string& encoding);

/// Reads a colour image: bgr8, rgb8, bgra8, rgba8, mono8, yuv422 (UYVY), yuv422_yuy2 (YUYV) or
/// 8-bit Bayer. Throws Error (input) that says what was expected.
void read_color(const ImageMessage& message, Image<Bgr>& color);
/// The same for a compressed one: JPEG or PNG.
void read_color(const CompressedImageMessage& message, Image<Bgr>& color);

/// Reads a depth image, 16UC1 (millimetres) or 32FC1 (metres). depth: in units of `unit_m`; 0 where
/// nothing was measured, or more than 16 bits hold. Throws Error (input).
void read_depth(const ImageMessage& message, double unit_m, Image<std::uint16_t>& depth);

/// A depth image in metres; 0 where nothing was measured. `read_depth` makes the same of it again.
Image<float> depth_in_metres(const Image<std::uint16_t>& depth, double unit_m);

/// Messages of pixels that the caller keeps: bgr8, 16UC1, 32FC1, mono8. Rows without gaps.
ImageMessage image_message(const Image<Bgr>& image);
ImageMessage image_message(const Image<std::uint16_t>& image);
ImageMessage image_message(const Image<float>& image);
ImageMessage image_message(const Image<std::uint8_t>& image);

}  // namespace diminish::ros
