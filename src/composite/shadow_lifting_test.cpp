#include "composite/shadow_lifting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace diminish {
namespace {

/// The lower half gets half of the light.
class HalfInShadow : public ::testing::Test {
 protected:
  HalfInShadow() {
    surfaces.region = Rect{10, 10, 80, 80};
    surfaces.light.resize(100, 100, {255, 255, 255});
    surfaces.light.fill({10, 50, 80, 40}, {128, 128, 128});
    occlusion.fill({20, 20, 60, 60}, 255);
    picture.fill({0, 50, 100, 50}, {50, 60, 70});
  }

  Surfaces surfaces;
  Mask occlusion{100, 100, 0};
  Image<Bgr> picture{100, 100, {100, 120, 140}};
  ShadowLifting lifting;
};

TEST_F(HalfInShadow, ShadowsAreLifted) {
  Image<Bgr> lit = picture;
  lifting.lift(surfaces, lit);
  for (int y = 10; y < 90; ++y) {
    for (int x = 10; x < 90; ++x) {
      ASSERT_LE(std::abs(lit(x, y).g - 120), 1) << x << ' ' << y;
    }
  }
  EXPECT_EQ(lit(5, 60), picture(5, 60)) << "outside the region";
}

TEST(ShadowLifting, DividesByTheLightAndRounds) {
  // All levels by all lights, and a row whose length fits no vector.
  const Rect all{0, 0, 256 + 3, 256};
  Surfaces surfaces;
  surfaces.region = all;
  surfaces.light.resize(all.width, all.height, {});
  Image<Bgr> picture(all.width, all.height);
  for (int y = 0; y < all.height; ++y) {
    for (int x = 0; x < all.width; ++x) {
      const auto level = static_cast<std::uint8_t>(x);
      const auto light = static_cast<std::uint8_t>(y);
      picture(x, y) = {level, light, level};
      surfaces.light(x, y) = {light, level, 255};
    }
  }
  const Image<Bgr> before = picture;
  ShadowLifting().lift(surfaces, picture);
  const auto lit = [](int level, int light) {
    return std::min(255, (level * 255 + light / 2) / std::max(light, 1));
  };
  for (int y = 0; y < all.height; ++y) {
    for (int x = 0; x < all.width; ++x) {
      const Bgr& light = surfaces.light(x, y);
      ASSERT_EQ(picture(x, y).b, lit(before(x, y).b, light.b)) << x << ' ' << y;
      ASSERT_EQ(picture(x, y).g, lit(before(x, y).g, light.g)) << x << ' ' << y;
      ASSERT_EQ(picture(x, y).r, before(x, y).r) << x << ' ' << y;
    }
  }
}

TEST_F(HalfInShadow, OutsideTheMaskTheCamerasPictureStaysAndNoLineShows) {
  const Image<Bgr> camera = picture;
  Image<Bgr> result = picture;
  lifting.lift(surfaces, result);
  lifting.restore_outside(camera, occlusion, surfaces, result);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      if (occlusion(x, y) == 0) {
        ASSERT_EQ(result(x, y), camera(x, y)) << x << ' ' << y;
      }
    }
  }
  // It becomes gradually lighter from the lower rim upwards and from left to right.
  for (int i = 0; i < 20; ++i) {
    EXPECT_GE(result(50, 79 - i).r, result(50, 80 - i).r);
    EXPECT_LE(result(50, 79 - i).r, result(50, 80 - i).r + 8);
    EXPECT_LE(std::abs(result(20 + i, 60).r - result(19 + i, 60).r), 8);
  }
  EXPECT_NEAR(result(50, 60).r, 140, 1) << "deep inside there is no shadow";
}

TEST_F(HalfInShadow, WithoutShadowNothingChanges) {
  surfaces.light.fill({255, 255, 255});
  Image<Bgr> result = picture;
  lifting.lift(surfaces, result);
  EXPECT_EQ(result, picture);
  lifting.restore_outside(Image<Bgr>(100, 100), occlusion, surfaces, result);
  EXPECT_EQ(result, picture);
}

}  // namespace
}  // namespace diminish
