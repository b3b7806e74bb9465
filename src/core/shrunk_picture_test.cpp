#include "core/shrunk_picture.h"

#include <gtest/gtest.h>

#include <random>

namespace diminish {
namespace {

/// Brightness is 3 x + 2 y: bilinear interpolation of means has no error.
Image<Bgr> ramp(int width, int height) {
  Image<Bgr> picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto level = static_cast<std::uint8_t>(3 * x + 2 * y);
      picture(x, y) = {level, level, level};
    }
  }
  return picture;
}

TEST(ShrunkPicture, ARampStaysOne) {
  const Image<Bgr> picture = ramp(40, 30);
  const Mask nothing(40, 30);
  std::mt19937 random(3);
  for (const int shrinkage : {1, 2, 4}) {
    ShrunkPicture small;
    small.begin(picture, nothing, shrinkage);
    ASSERT_EQ(small.width(), 40 / shrinkage);
    // A small pixel is the mean of four, the first one of its square and those half a side away.
    const float center = 0.5F * static_cast<float>(shrinkage / 2);
    for (int i = 0; i < 100; ++i) {
      const auto below = [&](int end) {
        return std::uniform_real_distribution<float>(0, static_cast<float>(end - 1))(random);
      };
      const float x = below(small.width());
      const float y = below(small.height());
      ShrunkPicture::Brightness found{};
      ASSERT_TRUE(small.look_up(x, y, found));
      const auto by = static_cast<float>(shrinkage);
      EXPECT_NEAR(found.level, 3 * (by * x + center) + 2 * (by * y + center), 1e-3F);
      EXPECT_NEAR(found.dx, 3 * by, 1e-3F);
      EXPECT_NEAR(found.dy, 2 * by, 1e-3F);
    }
  }
}

TEST(ShrunkPicture, TellsNothingOfObjectsNorOfThePictureBefore) {
  Image<Bgr> picture(32, 32, Bgr{200, 200, 200});
  Mask occlusion(32, 32);
  occlusion.fill({16, 0, 16, 32}, 255);
  ShrunkPicture small;
  ShrunkPicture::Brightness found{};
  for (const auto level : {std::uint8_t{200}, std::uint8_t{90}}) {
    picture.fill({level, level, level});
    small.begin(picture, occlusion, 4);
    for (float x = 0.25F; x < 7; ++x) {
      // The last small pixel before the object is number 3.
      EXPECT_EQ(small.look_up(x, 2.5F, found), x < 3) << x;
      if (x < 3) {
        EXPECT_NEAR(found.level, level, 1e-3F);
      }
    }
  }
}

}  // namespace
}  // namespace diminish
