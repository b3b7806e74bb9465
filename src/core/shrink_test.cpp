#include "core/shrink.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>

#include "core/mat.h"
#include "noise.h"

namespace diminish {
namespace {

TEST(Shrink, IsTheRoundedMean) {
  const Image<Bgr> image = testing::noise(101, 83);
  std::vector<std::uint16_t> scratch;
  Image<Bgr> small;
  for (int scale = 1; scale <= 16; ++scale) {
    SCOPED_TRACE(scale);
    shrink(image, scale, shrunk_bounds(image, scale), scratch, small);
    ASSERT_EQ(small.bounds(), (Rect{0, 0, 101 / scale, 83 / scale}));
    for (int y = 0; y < small.height(); ++y) {
      for (int x = 0; x < small.width(); ++x) {
        const cv::Rect cell(x * scale, y * scale, scale, scale);
        const cv::Scalar sum = cv::sum(as_mat(image)(cell));
        const auto mean = [&](int channel) {
          return static_cast<int>(std::floor(sum[channel] / cell.area() + 0.5));
        };
        ASSERT_EQ(small(x, y).b, mean(0)) << x << ' ' << y;
        ASSERT_EQ(small(x, y).g, mean(1)) << x << ' ' << y;
        ASSERT_EQ(small(x, y).r, mean(2)) << x << ' ' << y;
      }
    }
  }
}

TEST(Shrink, APictureThinnerThanTheScaleBecomesOnePixelWide) {
  Image<Bgr> image(40, 2, {10, 20, 30});
  image.fill({0, 1, 40, 1}, {30, 20, 10});
  std::vector<std::uint16_t> scratch;
  Image<Bgr> small;
  shrink(image, 4, shrunk_bounds(image, 4), scratch, small);
  EXPECT_EQ(small, Image<Bgr>(10, 1, {20, 20, 20}));
}

TEST(Shrink, APartIsThePartOfTheWhole) {
  const Image<Bgr> image = testing::noise(101, 83);
  const Rect part{4, 7, 19, 11};
  std::vector<std::uint16_t> scratch;
  Image<Bgr> whole, small;
  shrink(image, 4, shrunk_bounds(image, 4), scratch, whole);
  shrink(image, 4, part, scratch, small);
  ASSERT_EQ(small.bounds(), (Rect{0, 0, part.width, part.height}));
  EXPECT_EQ(cv::norm(as_mat(small), as_mat(whole)(as_cv(part)), cv::NORM_INF), 0);
}

TEST(ShrinkGreen, IsTheMeanOfTheMiddleRows) {
  std::mt19937 random(1);
  for (const int width : {43, 261, 1280}) {
    Image<Bgr> image(width, 18);
    for (Bgr& pixel : image) {
      pixel = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
               static_cast<std::uint8_t>(random())};
    }
    Image<std::uint8_t> small;
    shrink_green(image, small);
    ASSERT_EQ(small.width(), width / 4);
    ASSERT_EQ(small.height(), 4);
    for (int y = 0; y < small.height(); ++y) {
      for (int x = 0; x < small.width(); ++x) {
        double sum = 0;
        for (int i = 0; i < 4; ++i) {
          sum += image(4 * x + i, 4 * y + 1).g + image(4 * x + i, 4 * y + 2).g;
        }
        ASSERT_NEAR(small(x, y), sum / 8, 0.5) << width << ": " << x << ' ' << y;
      }
    }
  }
}

TEST(ShrinkOutside, IsTheWeightedMeanOfFourPixelsAndZeroOnTheMask) {
  const Image<Bgr> image = testing::noise(263, 83);
  std::mt19937 random(2);
  Mask mask(image.width(), image.height());
  for (std::uint8_t& value : mask) value = random() % 3 == 0 ? 255 : 0;
  Image<std::uint8_t> small;
  for (int scale = 1; scale <= 9; ++scale) {
    shrink_outside(image, mask, scale, small);
    ASSERT_EQ(small.bounds(), (Rect{0, 0, image.width() / scale, image.height() / scale}));
    const int near = scale / 4;
    const int far = scale - 1 - near;
    for (int y = 0; y < small.height(); ++y) {
      for (int x = 0; x < small.width(); ++x) {
        double sum = 0;
        for (const int row : {y * scale + near, y * scale + far}) {
          for (const int column : {x * scale + near, x * scale + far}) {
            const Bgr& color = image(column, row);
            sum += color.b / 4. + color.g / 2. + color.r / 4.;
          }
        }
        const bool is_masked = mask(x * scale + scale / 2, y * scale + scale / 2) != 0;
        ASSERT_EQ(small(x, y), is_masked ? 0 : std::max(1., std::floor(sum / 4)))
            << scale << ": " << x << ' ' << y;
      }
    }
  }
}

}  // namespace
}  // namespace diminish
