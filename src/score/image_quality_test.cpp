#include "score/image_quality.h"

#include <gtest/gtest.h>

#include <cmath>

namespace diminish {
namespace {

cv::Mat noise(int seed) {
  cv::Mat image(40, 50, CV_8UC3);
  cv::RNG random(static_cast<std::uint64_t>(seed));
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}
const cv::Mat everywhere(40, 50, CV_8U, cv::Scalar(255));

TEST(Quality, OfAConstantShiftIsItsFormulas) {
  const cv::Mat a(40, 50, CV_8UC3, cv::Scalar(100, 100, 100));
  const cv::Mat b(40, 50, CV_8UC3, cv::Scalar(110, 110, 110));
  const auto result = quality(b, a, ssim_map(b, a), everywhere);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->psnr_db, 20 * std::log10(255 / 10.0), 1e-9);
  const double c1 = 2.55 * 2.55;
  EXPECT_NEAR(result->ssim, (2 * 100 * 110 + c1) / (100 * 100 + 110 * 110 + c1), 1e-9);
}

TEST(Quality, OfTheSamePictureIsTheBest) {
  const cv::Mat a = noise(1);
  const auto result = quality(a, a, ssim_map(a, a), everywhere);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->psnr_db, 99);
  EXPECT_NEAR(result->ssim, 1, 1e-12);
}

// Nothing outside the region counts, and no region has no quality.
TEST(Quality, LooksAtTheRegionOnly) {
  const cv::Mat a = noise(1);
  cv::Mat b = a.clone();
  b.at<cv::Vec3b>(5, 5) = {0, 0, 0};
  cv::Mat region(40, 50, CV_8U, cv::Scalar(0));
  EXPECT_FALSE(quality(b, a, ssim_map(b, a), region));
  region.at<std::uint8_t>(30, 30) = 255;
  EXPECT_EQ(quality(b, a, ssim_map(b, a), region)->psnr_db, 99);
}

// Wang et al. 2004, written out for one pixel.
TEST(SsimMap, EqualsTheFormulaWrittenOut) {
  const cv::Mat a = noise(2);
  const cv::Mat b = noise(3);
  const auto brightness = [](const cv::Mat& image, int x, int y) {
    const auto& color = image.at<cv::Vec3b>(y, x);
    return std::round(0.114 * color[0] + 0.587 * color[1] + 0.299 * color[2]);
  };
  double weights = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
  for (int dy = -5; dy <= 5; ++dy) {
    for (int dx = -5; dx <= 5; ++dx) {
      const double w = std::exp(-(dx * dx + dy * dy) / (2 * 1.5 * 1.5));
      const double va = brightness(a, 25 + dx, 20 + dy);
      const double vb = brightness(b, 25 + dx, 20 + dy);
      weights += w;
      ma += w * va;
      mb += w * vb;
      aa += w * va * va;
      bb += w * vb * vb;
      ab += w * va * vb;
    }
  }
  ma /= weights;
  mb /= weights;
  const double expected =
      (2 * ma * mb + 6.5025) * (2 * (ab / weights - ma * mb) + 58.5225) /
      ((ma * ma + mb * mb + 6.5025) * (aa / weights - ma * ma + bb / weights - mb * mb + 58.5225));
  EXPECT_NEAR(ssim_map(a, b).at<double>(20, 25), expected, 1e-3);
}

}  // namespace
}  // namespace diminish
