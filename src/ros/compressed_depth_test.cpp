#include "ros/compressed_depth.h"

#include <gmock/gmock.h>

#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "core/mat.h"
#include "expect_error.h"

namespace diminish::ros {
namespace {

using ::testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;
using Depth = Image<std::uint16_t>;

Depth ramp() {
  Depth depth(31, 17);
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      depth(x, y) = static_cast<std::uint16_t>((x + y) % 7 == 0 ? 0 : 500 + 40 * x + y);
    }
  }
  return depth;
}

/// A message as compressed_depth_image_transport makes it, by OpenCV's PNG encoder.
Bytes with_config(const cv::Mat& image, float a, float b) {
  Bytes png, bytes(12);
  cv::imencode(".png", image, png);
  std::memcpy(bytes.data() + 4, &a, 4);
  std::memcpy(bytes.data() + 8, &b, 4);
  bytes.insert(bytes.end(), png.begin(), png.end());
  return bytes;
}

TEST(CompressedDepth, RvlLosesNothing) {
  Bytes bytes;
  const Depth depth = ramp();
  CompressedImageMessage message;
  message.format = write_compressed_depth(depth, bytes);
  message.data = bytes;
  Depth back;
  read_compressed_depth(message, .001, back);
  EXPECT_EQ(back, depth);
  bytes.resize(19);
  message.data = bytes;
  EXPECT_THAT(error_of([&] { read_compressed_depth(message, .001, back); }),
              HasSubstr("within its header"));
}

TEST(CompressedDepth, PngOfMillimetresIsRead) {
  const Depth depth = ramp();
  const Bytes bytes = with_config(as_mat(depth), 0, 0);
  Depth back;
  read_compressed_depth({{}, "16UC1; compressedDepth", bytes}, .001, back);
  EXPECT_EQ(back, depth);
  read_compressed_depth({{}, "16UC1; compressedDepth png", bytes}, .0005, back);
  EXPECT_EQ(back(3, 2), 2 * depth(3, 2));
}

TEST(CompressedDepth, InverseDepthIsRead) {
  // The transport's own formulas: A = quantisation * (quantisation + 1), B = 1 - A / largest depth.
  constexpr float quantisation = 100, largest_m = 10;
  const float a = quantisation * (quantisation + 1);
  const float b = 1 - a / largest_m;
  const Depth depth = ramp();
  Depth inverse(depth.width(), depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float metres = static_cast<float>(depth.data()[i]) * .001F;
    if (metres > 0) inverse.data()[i] = static_cast<std::uint16_t>(a / metres + b);
  }
  Depth back;
  read_compressed_depth({{}, "32FC1; compressedDepth png", with_config(as_mat(inverse), a, b)},
                        .001, back);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    // One step of inverse depth is depth^2 / A.
    const double metres = depth.data()[i] * .001;
    EXPECT_NEAR(back.data()[i] * .001, metres, metres * metres / a + .001);
    EXPECT_EQ(back.data()[i] == 0, depth.data()[i] == 0);
  }
}

TEST(CompressedDepth, WhatIsNotDepthIsRefused) {
  const auto error_for = [](const std::string& format, const Bytes& data) {
    CompressedImageMessage message;
    message.format = format;
    message.data = data;
    return error_of([&] {
      Depth back;
      read_compressed_depth(message, .001, back);
    });
  };
  const cv::Mat color(4, 4, CV_8UC3, cv::Scalar(1, 2, 3));
  EXPECT_THAT(error_for("16UC1; compressedDepth", with_config(color, 0, 0)),
              HasSubstr("one 16-bit channel"));
  EXPECT_THAT(error_for("bgr8; jpeg compressed", Bytes(40)),
              HasSubstr("expected compressed depth of 16UC1 or 32FC1, got 'bgr8; jpeg"));
  Bytes huge(40);
  huge[15] = 0x7f;  // of the width
  huge[16] = 1;
  EXPECT_THAT(error_for("16UC1; compressedDepth rvl", huge),
              HasSubstr("at most 67 million pixels"));
}

}  // namespace
}  // namespace diminish::ros
