#include "ros/compressed_depth.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <opencv2/core.hpp>

#include "core/mat.h"
#include "core/text.h"
#include "diminish/error.h"
#include "ros/depth_codec.h"
#include "ros/pixel_encodings.h"
#include "source/image_file.h"

namespace diminish::ros {
namespace {

/// compressed_depth_image_transport's ConfigHeader: a kind, and how inverse depth was made.
constexpr std::size_t config_bytes = 12;
constexpr std::size_t rvl_header_bytes = config_bytes + 8;

/// A number of four bytes, the least significant first, as on all machines that ROS runs on.
std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word |= std::uint32_t{bytes[at + i]} << 8 * i;
  return word;
}
void append_word(std::vector<std::uint8_t>& bytes, std::uint32_t word) {
  for (std::size_t i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(word >> 8 * i));
}

void decode_rvl(std::span<const std::uint8_t> data, Image<std::uint16_t>& depth) {
  if (data.size() < rvl_header_bytes) {
    throw Error(Error::input, "a compressed depth image ends within its header");
  }
  const std::uint32_t width = word_at(data, config_bytes);
  const std::uint32_t height = word_at(data, config_bytes + 4);
  expect_camera_size(width, height);
  depth.resize(static_cast<int>(width), static_cast<int>(height));
  decompress_depth(data.subspan(rvl_header_bytes), depth);
}

void decode_png(std::span<const std::uint8_t> data, Image<std::uint16_t>& depth) {
  const auto image = data.subspan(config_bytes);
  expect_declared_size(image);
  const cv::Mat decoded = decode<std::uint16_t>({image.begin(), image.end()});
  if (decoded.type() != CV_16UC1) {
    throw Error(Error::input, "expected a compressed depth image of one 16-bit channel");
  }
  copy_from(decoded, depth);
}

}  // namespace

void read_compressed_depth(const CompressedImageMessage& message, double unit_m,
                           Image<std::uint16_t>& depth) {
  if (message.data.size() < config_bytes) {
    throw Error(Error::input, "a compressed depth image ends within its header");
  }
  // "16UC1; compressedDepth", with "png" or "rvl" behind it since ROS Noetic.
  const std::string encoding = message.format.substr(0, message.format.find(';'));
  if (encoding != "16UC1" && encoding != "32FC1") {
    throw Error(Error::input, fmt::format("expected compressed depth of 16UC1 or 32FC1, got '{}'",
                                          printable(message.format)));
  }
  if (message.format.find("rvl") != std::string::npos) {
    decode_rvl(message.data, depth);
  } else {
    decode_png(message.data, depth);
  }
  if (encoding == "16UC1") return rescale_depth(millimetre_m, unit_m, depth);
  const auto a = std::bit_cast<float>(word_at(message.data, 4));
  const auto b = std::bit_cast<float>(word_at(message.data, 8));
  for (std::uint16_t& value : depth) {
    value = value == 0
                ? std::uint16_t{0}
                : depth_value(a / (static_cast<float>(value) - b), static_cast<float>(unit_m));
  }
}

std::string write_compressed_depth(const ImageView<std::uint16_t>& depth,
                                   std::vector<std::uint8_t>& data) {
  data.assign(config_bytes, 0);
  append_word(data, static_cast<std::uint32_t>(depth.width()));
  append_word(data, static_cast<std::uint32_t>(depth.height()));
  compress_depth(depth, data);
  return "16UC1; compressedDepth rvl";
}

}  // namespace diminish::ros
