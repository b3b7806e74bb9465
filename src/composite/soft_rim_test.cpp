#include "composite/soft_rim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/mat.h"

namespace diminish {
namespace {

const Image<Bgr> camera(90, 70, Bgr{200, 0, 40});
const Image<Bgr> background(90, 70, Bgr{80, 240, 40});

Image<Bgr> blended(const Mask& mask, int width_px) {
  Image<Bgr> picture = background;
  SoftRim().blend(camera, mask, bounding_box(mask), width_px, picture);
  return picture;
}

Mask random_blobs() {
  std::mt19937 random(5);
  Mask mask(90, 70, 0);
  for (int i = 0; i < 9; ++i) {
    cv::circle(as_mat(mask), {static_cast<int>(random() % 90), static_cast<int>(random() % 70)},
               static_cast<int>(6 + random() % 12), 255, cv::FILLED);
  }
  return mask;
}

// Rows are shared in bands of the box, which begin elsewhere in a larger one.
TEST(SoftRim, BandsLeaveNoTrace) {
  constexpr int width = 120;
  constexpr int height = 400;
  std::mt19937 random(3);
  Mask mask(width, height, 0);
  for (int i = 0; i < 60; ++i) {
    const cv::Point center(static_cast<int>(random() % width),
                           60 + static_cast<int>(random() % 280));
    cv::circle(as_mat(mask), center, static_cast<int>(4 + random() % 12), 255, cv::FILLED);
  }
  const Image<Bgr> from(width, height, Bgr{200, 0, 40});
  const Image<Bgr> to(width, height, Bgr{80, 240, 40});
  for (const int width_px : {1, 2, 5}) {
    Image<Bgr> picture = to;
    SoftRim().blend(from, mask, bounding_box(mask), width_px, picture);
    for (const int more : {7, 33}) {
      Image<Bgr> other = to;
      SoftRim().blend(from, mask, intersect(grow(bounding_box(mask), more), mask.bounds()),
                      width_px, other);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) ASSERT_EQ(picture(x, y), other(x, y)) << x << ", " << y;
      }
    }
  }
}

// The share of the background grows with the distance that OpenCV measures.
TEST(SoftRim, PassesFromCameraToBackground) {
  const Mask mask = random_blobs();
  constexpr int width_px = 4;
  const Image<Bgr> picture = blended(mask, width_px);
  cv::Mat padded;
  cv::copyMakeBorder(as_mat(mask), padded, 20, 20, 20, 20, cv::BORDER_REPLICATE);
  cv::Mat distance;
  cv::distanceTransform(padded, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  int rim = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask(x, y) == 0) {
        ASSERT_EQ(picture(x, y), background(x, y)) << "only the mask is changed";
        continue;
      }
      const double distance_px = distance.at<float>(y + 20, x + 20);
      const double share = std::min(1.0, distance_px / (width_px + 1));
      const double expected = 240 * share;
      ASSERT_NEAR(picture(x, y).g, expected, 240 * 0.21) << x << ' ' << y;
      ASSERT_NEAR(picture(x, y).b, 200 - 120 * share, 120 * 0.21 + 1) << x << ' ' << y;
      ASSERT_EQ(picture(x, y).r, 40);
      rim += share < 1 ? 1 : 0;
    }
  }
  EXPECT_GT(rim, 300);
}

TEST(SoftRim, AStraightEdgePassesEvenly) {
  Mask mask(90, 70, 0);
  mask.fill({30, 0, 60, 70}, 255);  // to the images' borders, which are no rim
  const Image<Bgr> picture = blended(mask, 2);
  for (int y = 0; y < 70; ++y) {
    EXPECT_EQ(picture(29, y).g, 240);
    EXPECT_EQ(picture(30, y).g, 80);
    EXPECT_EQ(picture(31, y).g, 160);
    for (int x = 32; x < 90; ++x) ASSERT_EQ(picture(x, y).g, 240);
  }
}

TEST(SoftRim, WithoutWidthOrMaskNothingChanges) {
  EXPECT_EQ(blended(random_blobs(), 0), background);
  EXPECT_EQ(blended(Mask(90, 70, 0), 3), background);
}

}  // namespace
}  // namespace diminish
