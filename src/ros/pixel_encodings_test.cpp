#include "ros/pixel_encodings.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "core/mat.h"
#include "expect_error.h"

namespace diminish::ros {
namespace {

using ::testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;

ImageMessage message(int width, int height, const std::string& encoding, std::uint32_t step,
                     const Bytes& data) {
  ImageMessage image;
  image.width = static_cast<std::uint32_t>(width);
  image.height = static_cast<std::uint32_t>(height);
  image.encoding = encoding;
  image.step = step;
  image.data = data;
  return image;
}

TEST(PixelEncodings, ChannelsGoWhereTheyBelong) {
  Image<Bgr> color;
  const Bytes three = {1, 2, 3, 4, 5, 6, 0, 7, 8, 9, 10, 11, 12};  // rows of 7 bytes
  read_color(message(2, 2, "bgr8", 7, three), color);
  EXPECT_EQ(color(1, 1), (Bgr{10, 11, 12}));
  read_color(message(2, 2, "rgb8", 7, three), color);
  EXPECT_EQ(color(0, 0), (Bgr{3, 2, 1}));
  EXPECT_EQ(color(0, 1), (Bgr{9, 8, 7}));
  const Bytes four = {1, 2, 3, 4, 5, 6, 7, 8};
  read_color(message(2, 1, "bgra8", 8, four), color);
  EXPECT_EQ(color(1, 0), (Bgr{5, 6, 7}));
  read_color(message(2, 1, "rgba8", 8, four), color);
  EXPECT_EQ(color(1, 0), (Bgr{7, 6, 5}));
  read_color(message(2, 1, "mono8", 2, {9, 200}), color);
  EXPECT_EQ(color(1, 0), (Bgr{200, 200, 200}));
}

/// A picture of one colour, which each pattern sees through its own filters.
TEST(PixelEncodings, BayerPatternsAreTold) {
  const Bgr truth{40, 90, 220};
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    Bytes mosaic(12 * 10);
    for (std::size_t i = 0; i < mosaic.size(); ++i) {
      const std::size_t x = i % 12;
      const std::size_t y = i / 12;
      const char filter = pattern[2 * (y % 2) + x % 2];
      mosaic[i] = filter == 'r' ? truth.r : filter == 'g' ? truth.g : truth.b;
    }
    Image<Bgr> color;
    read_color(message(12, 10, "bayer_" + pattern + "8", 12, mosaic), color);
    for (int y = 2; y < 8; ++y) {
      for (int x = 2; x < 10; ++x) EXPECT_EQ(color(x, y), truth) << pattern;
    }
  }
}

/// ITU-R BT.601 by its formulas, in studio range as video has it.
TEST(PixelEncodings, YuvIsConverted) {
  const Bgr truth{40, 90, 220};
  const double y = 16 + .257 * truth.r + .504 * truth.g + .098 * truth.b;
  const double u = 128 - .148 * truth.r - .291 * truth.g + .439 * truth.b;
  const double v = 128 + .439 * truth.r - .368 * truth.g - .071 * truth.b;
  const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(value)); };
  const Bytes uyvy = {byte(u), byte(y), byte(v), byte(y)};
  const Bytes yuyv = {byte(y), byte(u), byte(y), byte(v)};
  for (const auto& [name, bytes] : {std::pair{"yuv422", uyvy}, {"yuv422_yuy2", yuyv}}) {
    Image<Bgr> color;
    read_color(message(2, 1, name, 4, bytes), color);
    for (int x = 0; x < 2; ++x) {
      EXPECT_NEAR(color(x, 0).b, truth.b, 3) << name;
      EXPECT_NEAR(color(x, 0).g, truth.g, 3) << name;
      EXPECT_NEAR(color(x, 0).r, truth.r, 3) << name;
    }
  }
}

TEST(PixelEncodings, DepthIsReadInBothTypesAndByteOrders) {
  Image<std::uint16_t> depth;
  read_depth(message(2, 1, "16UC1", 4, {0x34, 0x12, 0, 0}), .001, depth);
  EXPECT_EQ(depth(0, 0), 0x1234);
  ImageMessage big = message(2, 1, "16UC1", 4, {});
  const Bytes big_data = {0x12, 0x34, 0, 1};
  big.data = big_data;
  big.is_big_endian = true;
  read_depth(big, .001, depth);
  EXPECT_EQ(depth(0, 0), 0x1234);
  EXPECT_EQ(depth(1, 0), 1);
  read_depth(message(2, 1, "16UC1", 4, {0xe8, 3, 0, 0}), .0005, depth);
  EXPECT_EQ(depth(0, 0), 2000);

  const std::array<float, 6> metres = {
      1.5F, 0, std::nanf(""), -1, std::numeric_limits<float>::infinity(), 70};
  Bytes data(sizeof(metres));
  std::memcpy(data.data(), metres.data(), data.size());
  read_depth(message(6, 1, "32FC1", 24, data), .001, depth);
  EXPECT_THAT(std::vector(depth.begin(), depth.end()), ::testing::ElementsAre(1500, 0, 0, 0, 0, 0));
  for (std::size_t i = 0; i < data.size(); i += 4) std::reverse(&data[i], &data[i] + 4);
  ImageMessage swapped = message(6, 1, "32FC1", 24, data);
  swapped.is_big_endian = true;
  read_depth(swapped, .0001, depth);
  EXPECT_EQ(depth(0, 0), 15000);
}

TEST(PixelEncodings, CompressedColourIsRead) {
  cv::Mat picture(8, 8, CV_8UC3, cv::Scalar(40, 90, 220));
  for (const char* extension : {".png", ".jpg"}) {
    Bytes bytes;
    cv::imencode(extension, picture, bytes);
    Image<Bgr> color;
    read_color(CompressedImageMessage{{}, "jpeg", bytes}, color);
    EXPECT_EQ(color.width(), 8);
    EXPECT_NEAR(color(3, 3).r, 220, 3);
    EXPECT_NEAR(color(3, 3).b, 40, 3);
  }
}

TEST(PixelEncodings, WhatDoesNotFitIsRefused) {
  Image<Bgr> color;
  Image<std::uint16_t> depth;
  EXPECT_THAT(error_of([&] { read_color(message(2, 2, "bgr8", 6, Bytes(11)), color); }),
              HasSubstr("expected 12 bytes of bgr8 for 2x2 with rows of 6, got 11"));
  EXPECT_THAT(error_of([&] { read_color(message(2, 2, "bgr8", 5, Bytes(20)), color); }),
              HasSubstr("rows of 5"));
  EXPECT_THAT(error_of([&] { read_color(message(3, 1, "yuv422", 6, Bytes(6)), color); }),
              HasSubstr("even width"));
  EXPECT_THAT(error_of([&] { read_color(message(2, 2, "16UC1", 4, Bytes(8)), color); }),
              HasSubstr("expected a colour image as one of bgr8"));
  EXPECT_THAT(error_of([&] { read_depth(message(2, 2, "bgr8", 6, Bytes(12)), .001, depth); }),
              HasSubstr("expected a depth image as 16UC1 or 32FC1, got 'bgr8'"));
  ImageMessage huge = message(0, 4, "bgr8", 0, {});
  EXPECT_THAT(error_of([&] { read_color(huge, color); }), HasSubstr("got 0x4"));
  huge.width = huge.height = huge.step = 0xffffffff;
  EXPECT_THAT(error_of([&] { read_color(huge, color); }), HasSubstr("million pixels"));
}

TEST(PixelEncodings, ImagesAreWrittenAsTheyAre) {
  Image<std::uint16_t> depth(3, 2, 1234);
  depth(2, 1) = 7;
  Image<std::uint16_t> back;
  read_depth(image_message(depth), .001, back);
  EXPECT_EQ(back, depth);
  Image<Bgr> color(3, 2, Bgr{1, 2, 3});
  Image<Bgr> color_back;
  read_color(image_message(color), color_back);
  EXPECT_EQ(color_back, color);
}

}  // namespace
}  // namespace diminish::ros
