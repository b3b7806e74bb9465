#include "sink/png_encoder.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

namespace diminish {
namespace {

// Another program reads what we wrote.
TEST(PngEncoder, EveryPixelComesBack) {
  cv::RNG random(1);
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4}) {
    for (const cv::Size size :
         {cv::Size(1, 1), cv::Size(1, 9), cv::Size(13, 1), cv::Size(257, 31)}) {
      cv::Mat noise(size, type);
      random.fill(noise, cv::RNG::UNIFORM, 0, 256);
      const cv::Mat flat(size, type, cv::Scalar(0, 255, 1, 254));
      for (const cv::Mat& picture : {noise, flat}) {
        const cv::Mat read = cv::imdecode(encode_png(picture), cv::IMREAD_UNCHANGED);
        ASSERT_EQ(read.size(), size);
        ASSERT_EQ(read.type(), type);
        EXPECT_EQ(cv::norm(read, picture, cv::NORM_INF), 0);
      }
    }
  }
}

TEST(PngEncoder, APartOfAPictureIsAPicture) {
  cv::Mat whole(20, 30, CV_8UC3);
  cv::randu(whole, 0, 256);
  const cv::Mat part = whole(cv::Rect(3, 4, 17, 11));
  const cv::Mat read = cv::imdecode(encode_png(part), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.size(), part.size());
  EXPECT_EQ(cv::norm(read, part, cv::NORM_INF), 0);
}

TEST(PngEncoder, EvenPicturesAreSmall) {
  const cv::Mat even(480, 640, CV_8UC3, cv::Scalar(9, 8, 7));
  EXPECT_LT(encode_png(even).size(), 10000U);
}

}  // namespace
}  // namespace diminish
