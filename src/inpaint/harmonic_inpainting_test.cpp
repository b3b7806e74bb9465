#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "diminish/inpainter.h"
#include "laplace_equation.h"

namespace diminish {
namespace {

Image<Bgr> inpaint(const Image<Bgr>& picture, const Mask& missing) {
  Image<Bgr> filled = picture;
  EXPECT_TRUE(Registry<Inpainter>::get("harmonic")()->inpaint({missing, missing, {}}, {}, filled));
  return filled;
}

// A ramp is harmonic: whatever the hole, it is filled exactly.
TEST(HarmonicInpainting, ContinuesARamp) {
  Image<Bgr> picture(90, 70);
  Mask missing(90, 70, 0);
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 90; ++x) {
      picture(x, y) = {static_cast<std::uint8_t>(2 * x), static_cast<std::uint8_t>(3 * y),
                       static_cast<std::uint8_t>(x + y)};
      if (std::hypot(x - 40, y - 35) < 25 || (x > 10 && x < 80 && y == 8)) missing(x, y) = 255;
    }
  }
  EXPECT_EQ(inpaint(picture, missing), picture);
}

TEST(HarmonicInpainting, EqualsADirectSolve) {
  std::mt19937 random(4);
  const auto level = [&] { return static_cast<std::uint8_t>(random()); };
  Image<Bgr> picture(60, 45);
  Mask missing(60, 45, 0);
  for (Bgr& pixel : picture) pixel = {level(), level(), level()};
  missing.fill({0, 5, 30, 30}, 255);  // at the picture's edge: free there
  missing.fill({35, 10, 15, 2}, 255);
  const Image<Bgr> filled = inpaint(picture, missing);
  const Image<Eigen::Array3d> exact = testing::exact_filling(picture, missing);
  for (int y = 0; y < 45; ++y) {
    for (int x = 0; x < 60; ++x) {
      if (missing(x, y) == 0) {
        ASSERT_EQ(filled(x, y), picture(x, y));
        continue;
      }
      // Half a level for rounding and what the solver may leave of neighbours that differ by 255.
      ASSERT_NEAR(filled(x, y).b, exact(x, y)[0], 1.3);
      ASSERT_NEAR(filled(x, y).g, exact(x, y)[1], 1.3);
      ASSERT_NEAR(filled(x, y).r, exact(x, y)[2], 1.3);
    }
  }
}

// Black, and said so: there is nothing to look at.
TEST(HarmonicInpainting, SaysThatNothingIsKnown) {
  Image<Bgr> picture(9, 7, {1, 2, 3});
  const Mask missing(9, 7, 255);
  EXPECT_FALSE(
      Registry<Inpainter>::get("harmonic")()->inpaint({missing, missing, {}}, {}, picture));
  EXPECT_EQ(picture, Image<Bgr>(9, 7));
}

}  // namespace
}  // namespace diminish
