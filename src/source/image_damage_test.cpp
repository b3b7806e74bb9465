#include "source/image_damage.h"

#include <gmock/gmock.h>
#include <turbojpeg.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "diminish/error.h"
#include "expect_error.h"
#include "source/image_file.h"
#include "source/jpeg_decoder.h"

namespace diminish {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Noise, with something to see.
cv::Mat picture(int type = CV_8UC3) {
  cv::Mat image(90, 130, type);
  cv::randu(image, cv::Scalar::all(0), cv::Scalar::all(255));
  cv::GaussianBlur(image, image, {}, 2);
  cv::circle(image, {60, 40}, 30, cv::Scalar::all(200), -1);
  return image;
}

Bytes encoded(const char* format, const cv::Mat& image, const std::vector<int>& how = {}) {
  Bytes bytes;
  cv::imencode(format, image, bytes, how);
  return bytes;
}

bool is_same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(JpegDecoder, MakesWhatOpenCvMakes) {
  for (const int subsampling : {TJSAMP_411, TJSAMP_420, TJSAMP_422, TJSAMP_440, TJSAMP_444}) {
    for (const int how : {0, TJFLAG_PROGRESSIVE}) {
      const cv::Mat image = picture();
      unsigned char* data = nullptr;
      unsigned long size = 0;  // NOLINT(google-runtime-int): theirs
      const tjhandle encoder = tjInitCompress();
      ASSERT_EQ(tjCompress2(encoder, image.data, image.cols, 0, image.rows, TJPF_BGR, &data, &size,
                            subsampling, 90, how),
                0);
      const Bytes bytes(data, data + size);
      tjFree(data);
      tjDestroy(encoder);
      EXPECT_TRUE(is_same(decode_jpeg(bytes), cv::imdecode(bytes, cv::IMREAD_COLOR)))
          << subsampling << " " << how;
    }
  }
  const Bytes grey = encoded(".jpg", picture(CV_8UC1));
  EXPECT_TRUE(is_same(decode_jpeg(grey), cv::imdecode(grey, cv::IMREAD_COLOR)));
}

TEST(JpegDecoder, RefusesDamagedPixels) {
  const Bytes whole = encoded(".jpg", picture());
  std::mt19937 random(1);
  int refused = 0;
  ::testing::internal::CaptureStderr();
  for (int i = 0; i < 50; ++i) {
    Bytes damaged = whole;
    // Among the coded pixels. No marker comes about.
    const std::size_t first = whole.size() / 3 + random() % (whole.size() / 2);
    for (std::size_t k = first; k < first + 16; ++k) {
      damaged[k] = static_cast<std::uint8_t>(random() % 255);
    }
    try {
      decode<Bgr>(damaged);
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), ::testing::StartsWith("the file is damaged: "));
      ++refused;
    }
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  // In the others the decoder finds its way again within a few bytes.
  EXPECT_GE(refused, 20);
}

// A webcam's torn picture must not take the next ones with it.
TEST(JpegDecoder, ADamagedPictureDoesNotSpoilTheNext) {
  const Bytes good = encoded(".jpg", picture());
  const cv::Mat expected = decode_jpeg(good);
  const auto place_of = [&](std::uint8_t marker) {
    const Bytes bytes = {0xff, marker};
    const auto found = std::search(good.begin(), good.end(), bytes.begin(), bytes.end());
    return static_cast<std::size_t>(found - good.begin());
  };
  const std::size_t tables_begin = place_of(0xc4);  // Huffman tables, up to the pixels
  const std::size_t tables_end = place_of(0xda);
  std::mt19937 random(4);
  int refused = 0;
  for (int i = 0; i < 500; ++i) {
    Bytes spoilt = good;
    for (int k = 0; k < 3; ++k) {
      spoilt[tables_begin + random() % (tables_end - tables_begin)] =
          static_cast<std::uint8_t>(random());
    }
    try {
      decode_jpeg(spoilt);
    } catch (const Error&) {
      ++refused;
    }
    ASSERT_TRUE(is_same(decode_jpeg(good), expected)) << i;
  }
  EXPECT_GT(refused, 100);
}

TEST(JpegDecoder, BytesBetweenMarkersAreNoDamage) {
  Bytes bytes = encoded(".jpg", picture());
  const cv::Mat expected = decode_jpeg(bytes);
  bytes.insert(bytes.end() - 2, {0x12, 0x34, 0x56});
  EXPECT_TRUE(is_same(decode_jpeg(bytes), expected));
}

TEST(ImageDamage, EveryChangedByteOfAPngIsFound) {
  const Bytes whole = encoded(".png", picture(CV_16UC1)(cv::Rect(0, 0, 20, 10)));
  EXPECT_EQ(damage_of(whole), nullptr);
  for (std::size_t i = 8; i < whole.size(); ++i) {
    for (const int change : {1, 0x80, 0xff}) {
      Bytes damaged = whole;
      damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ change);
      ASSERT_NE(damage_of(damaged), nullptr) << i;
    }
    ASSERT_STREQ(damage_of(std::span(whole).first(i)), "the file is cut short") << i;
  }
  Bytes damaged = whole;
  damaged[whole.size() / 2] ^= 1;
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(error_of([&] { decode<std::uint16_t>(damaged); }), "the file is damaged");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(ImageDamage, OtherFormatsAreNotJudged) {
  EXPECT_EQ(damage_of(encoded(".bmp", picture())), nullptr);
  EXPECT_EQ(damage_of({}), nullptr);
}

}  // namespace
}  // namespace diminish
