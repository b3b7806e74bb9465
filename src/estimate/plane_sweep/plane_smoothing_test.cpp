#include "estimate/plane_sweep/plane_smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "each_vector_target.h"

namespace diminish {
namespace {

/// Two slanted planes with a step between them, at column 50.
float truth(int x, int y) {
  return (x < 50 ? 1.F : 2.F) + 0.004F * static_cast<float>(x) - 0.002F * static_cast<float>(y);
}

Image<float> planes(float noise, int width = 100, int height = 70) {
  Image<float> image(width, height);
  std::mt19937 random(1);
  std::normal_distribution<float> jitter(0, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image(x, y) = truth(x, y) + noise * jitter(random);
  }
  return image;
}

double rms_error(const Image<float>& image) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) sum += std::pow(image(x, y) - truth(x, y), 2);
  }
  return std::sqrt(sum / static_cast<double>(image.size()));
}

TEST(PlaneSmoothing, LeavesPlanesAndEdgesAsTheyAre) {
  Image<float> image = planes(0);
  PlaneSmoothing().smooth(0.2F, 4, image);
  EXPECT_LT(rms_error(image), 1e-6);
}

TEST(PlaneSmoothing, RemovesNoise) {
  Image<float> image = planes(0.02F);
  const double before = rms_error(image);
  PlaneSmoothing().smooth(0.2F, 4, image);
  EXPECT_LT(rms_error(image), before / 4);
}

TEST(PlaneSmoothing, UnknownPixelsStayUnknownAndDoNotCount) {
  Image<float> image = planes(0);
  image(30, 30) = 0;
  PlaneSmoothing().smooth(0.2F, 2, image);
  EXPECT_EQ(image(30, 30), 0);
  EXPECT_NEAR(image(31, 30), truth(31, 30), 1e-6);
}

TEST(PlaneSmoothing, IsTheSameOnAllMachines) {
  for (const auto& [width, height] : {std::pair{100, 70}, {7, 9}, {1, 40}, {33, 3}}) {
    std::optional<Image<float>> first;
    testing::on_each_vector_target([&, width = width, height = height] {
      Image<float> image = planes(0.02F, width, height);
      PlaneSmoothing().smooth(0.1F, 4, image);
      if (!first) first = image;
      EXPECT_EQ(image, *first);
    });
  }
}

}  // namespace
}  // namespace diminish
