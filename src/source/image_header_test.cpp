#include "source/image_header.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <random>
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
  EXPECT_FALSE(declared_size(encoded(".bmp", 4, 4)));
}

TEST(ImageHeader, ABrokenOneHasNoneAndIsNotReadPastItsEnd) {
  std::mt19937 random(1);
  for (const char* format : {".png", ".jpg"}) {
    const Bytes whole = encoded(format, 40, 30);
    for (std::size_t length = 0; length < 24; ++length) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
      EXPECT_FALSE(declared_size(cut)) << format << length;
    }
    for (int i = 0; i < 2000; ++i) {
      Bytes spoilt = whole;
      for (int k = 0; k < 4; ++k) spoilt[random() % 64] = static_cast<std::uint8_t>(random());
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
}

}  // namespace
}  // namespace diminish
