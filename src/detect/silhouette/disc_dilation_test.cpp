#include "detect/silhouette/disc_dilation.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "core/mat.h"

namespace diminish {
namespace {

cv::Mat disc(int radius) {
  cv::Mat kernel(2 * radius + 1, 2 * radius + 1, CV_8U);
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) {
      kernel.at<std::uint8_t>(y + radius, x + radius) = x * x + y * y <= radius * radius;
    }
  }
  return kernel;
}

Mask random_mask(int width, int height, double density, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution set(density);
  Mask mask(width, height);
  for (std::uint8_t& pixel : mask) pixel = set(random) ? 255 : 0;
  return mask;
}

struct Case {
  int width, height, radius;
  double density;
};
const Case cases[] = {{1, 1, 1, 1},        {1, 1, 3, 0},          {3, 13, 2, 0.1},
                      {257, 13, 1, 0.01},  {64, 48, 0, 0.1},      {64, 48, 3, 0.01},
                      {131, 97, 6, 0.003}, {97, 131, 25, 0.0005}, {20, 20, 40, 0.01},
                      {33, 31, 5, 1}};

TEST(DiscDilation, SetsWhatOpenCvSetsWithTheSameDisc) {
  DiscDilation dilation;
  for (const auto& [width, height, radius, density] : cases) {
    SCOPED_TRACE(radius);
    const Mask before = random_mask(width, height, density, 1);
    Mask expected(width, height);
    cv::dilate(as_mat(before), as_mat(expected), disc(radius));
    Mask mask = before;
    dilation.dilate(mask, radius);
    EXPECT_EQ(mask, expected);
  }
}

TEST(DiscDilation, ClosesWhatOpenCvClosesWithTheSameDisc) {
  DiscDilation dilation;
  for (const auto& [width, height, radius, density] : cases) {
    SCOPED_TRACE(radius);
    const Mask before = random_mask(width, height, std::min(1.0, 5 * density), 2);
    Mask expected(width, height);
    cv::dilate(as_mat(before), as_mat(expected), disc(radius));
    cv::erode(as_mat(expected), as_mat(expected), disc(radius));
    Mask mask = before;
    dilation.close(mask, radius);
    EXPECT_EQ(mask, expected);
  }
}

}  // namespace
}  // namespace diminish
