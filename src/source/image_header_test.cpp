#include "source/image_header.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <random>
#include <string>
#include <vector>

#include "diminish/error.h"
#include "expect_error.h"
#include "source/image_file.h"

namespace diminish {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes encoded(const char* format, int width, int height, const std::vector<int>& how = {}) {
  Bytes bytes;
  cv::imencode(format, cv::Mat(height, width, CV_8UC3, cv::Scalar(10, 120, 200)), bytes, how);
  return bytes;
}

TEST(ImageHeader, HasTheSizeThatADecoderFinds) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(640, 3), cv::Size(37, 700)}) {
    EXPECT_EQ(declared_size(encoded(".png", size.width, size.height)), size);
    EXPECT_EQ(declared_size(encoded(".jpg", size.width, size.height)), size);
    EXPECT_EQ(
        declared_size(encoded(".jpg", size.width, size.height,
                              {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 4})),
        size);
  }
}

TEST(ImageHeader, ReadsOtherFormatsToo) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(640, 3), cv::Size(37, 700)}) {
    for (const char* format : {".bmp", ".tif", ".ppm"}) {
      EXPECT_EQ(declared_size(encoded(format, size.width, size.height)), size) << format;
    }
    EXPECT_EQ(declared_size(encoded(".webp", size.width, size.height)), size);
    EXPECT_EQ(
        declared_size(encoded(".webp", size.width, size.height, {cv::IMWRITE_WEBP_QUALITY, 101})),
        size)
        << "lossless";
    Bytes bytes;
    cv::imencode(".pgm", cv::Mat(size, CV_16UC1, cv::Scalar(900)), bytes);
    EXPECT_EQ(declared_size(bytes), size);
    EXPECT_EQ(decode<std::uint16_t>(bytes).size(), size);
    // A list of coded strips instead of one, 16 bits a channel
    cv::imencode(".tiff", cv::Mat(size, CV_16UC1, cv::Scalar(900)), bytes);
    EXPECT_EQ(declared_size(bytes), size);
    EXPECT_EQ(decode<std::uint16_t>(bytes).size(), size);
  }
  const std::string commented = "P5 # made by hand\n# 99 99\n3\t2 9\n123456";
  EXPECT_EQ(declared_size(Bytes(commented.begin(), commented.end())), cv::Size(3, 2));
  Bytes upside_down = encoded(".bmp", 7, 5);
  for (std::size_t i = 22; i < 26; ++i) upside_down[i] = i == 22 ? 0xfb : 0xff;  // -5
  EXPECT_EQ(declared_size(upside_down), cv::Size(7, 5));
  EXPECT_EQ(decode<Bgr>(upside_down).size(), cv::Size(7, 5));
}

TEST(ImageHeader, ABrokenOneHasNoneAndIsNotReadPastItsEnd) {
  std::mt19937 random(1);
  for (const char* format : {".png", ".jpg", ".bmp", ".tif", ".ppm", ".webp"}) {
    const Bytes whole = encoded(format, 40, 30);
    const std::size_t header = std::string(format) == ".ppm" ? 6 : 24;
    for (std::size_t length = 0; length < header; ++length) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
      EXPECT_FALSE(declared_size(cut)) << format << length;
    }
    for (int i = 0; i < 2000; ++i) {
      Bytes spoilt = whole;
      for (int k = 0; k < 4; ++k)
        spoilt[random() % std::min<std::size_t>(64, spoilt.size())] =
            static_cast<std::uint8_t>(random());
      spoilt.resize(random() % spoilt.size());
      spoilt.shrink_to_fit();
      declared_size(spoilt);
    }
  }
}

TEST(ImageHeader, AnImageThatClaimsGigabytesIsRefusedInOneLine) {
  Bytes bytes = encoded(".png", 4, 4);
  bytes[16 + 1] = bytes[20 + 1] = 2;  // 131076x131076
  EXPECT_EQ(error_of([&] { decode<Bgr>(bytes); }),
            "expected at most 268 million pixels, got 131076x131076");
  bytes = encoded(".bmp", 4, 4);
  bytes[18 + 2] = bytes[22 + 2] = 2;
  EXPECT_EQ(error_of([&] { decode<std::uint16_t>(bytes); }),
            "expected at most 268 million pixels, got 131076x131076");
  const std::string text = "P5 200000 200000 255\n";
  EXPECT_EQ(error_of([&] { decode<Bgr>(Bytes(text.begin(), text.end())); }),
            "expected at most 268 million pixels, got 200000x200000");
}

// Decoders would say so on stderr.
TEST(ImageHeader, WhatIsCutShortIsNotDecoded) {
  for (const char* format : {".png", ".jpg", ".bmp", ".ppm"}) {
    Bytes bytes = encoded(format, 40, 30);
    EXPECT_NO_THROW(decode<Bgr>(bytes)) << format;
    bytes.pop_back();
    EXPECT_EQ(error_of([&] { decode<Bgr>(bytes); }), "the file is cut short") << format;
  }
}

TEST(ImageHeader, AFormatWhoseSizeIsNotReadIsRefused) {
  EXPECT_EQ(error_of([&] { decode<Bgr>(encoded(".jp2", 40, 40)); }),
            "cannot be decoded, expected PNG, JPEG, BMP, TIFF, WebP, PGM or PPM");
}

}  // namespace
}  // namespace diminish
