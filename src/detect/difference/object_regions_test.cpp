#include "detect/difference/object_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "detect/difference/geodesic_fill.h"

namespace diminish {
namespace {

Image<Shown> blank(int width, int height) {
  return Image<Shown>(width, height, Shown::unknown);
}

/// A grey step across the picture, one level of noise, a pixel of each kind on both sides.
TEST(GeodesicFill, StopsAtAnEdge) {
  constexpr int width = 60;
  constexpr int height = 40;
  Image<Bgr> picture(width, height);
  std::mt19937 random(3);
  const auto edge = [](int y) { return 20 + y / 4; };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto level = static_cast<std::uint8_t>((x < edge(y) ? 80 : 120) + random() % 2);
      picture(x, y) = {level, level, level};
    }
  }
  Image<Shown> shown(width, height, Shown::unlike);
  shown(4, 20) = Shown::object;
  shown(55, 20) = Shown::scene;
  GeodesicFill fill;
  fill.fill(picture, picture.bounds(), shown);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      EXPECT_EQ(shown(x, y), x < edge(y) ? Shown::object : Shown::scene) << x << " " << y;
    }
  }
}

/// Where no camera sees anything, guesses do not go far.
TEST(GeodesicFill, LeavesWhatIsFarAway) {
  const Image<Bgr> picture(100, 9, Bgr{90, 90, 90});
  Image<Shown> shown = blank(100, 9);
  shown.fill({0, 0, 1, 9}, Shown::object);
  GeodesicFill fill;
  fill.fill(picture, picture.bounds(), shown);
  EXPECT_EQ(shown(25, 4), Shown::object);
  EXPECT_EQ(shown(40, 4), Shown::unknown);
}

TEST(ObjectRegions, LeavesOutWhatIsSmallOrGuessed) {
  Image<Shown> evidence = blank(320, 240);
  evidence.fill({10, 10, 30, 30}, Shown::unseen_object);    // enough
  evidence.fill({80, 10, 20, 20}, Shown::unseen_object);    // too small
  evidence.fill({120, 10, 20, 20}, Shown::object);          // small, but a camera sees it
  evidence.fill({200, 100, 10, 40}, Shown::unseen_object);  // a sixth of its region
  Image<Shown> shown = evidence;
  shown.fill({200, 100, 60, 40}, Shown::unseen_object);
  Mask regions;
  shown.fill({20, 20, 10, 10}, Shown::scene);  // a hole that is too small, and one that is not
  shown.fill({122, 12, 16, 16}, Shown::scene);
  ObjectRegions().find(evidence, shown, regions);
  Mask expected(320, 240);
  expected.fill({10, 10, 30, 30}, 255);
  expected.fill({120, 10, 20, 20}, 255);
  expected.fill({122, 12, 16, 16}, 0);
  EXPECT_EQ(regions, expected);
}

/// As interpolation pixel by pixel would have it.
TEST(AddEnlarged, IsTheInterpolatedMasksHalf) {
  std::mt19937 random(5);
  for (const int shrinkage : {1, 2, 3, 4, 7}) {
    SCOPED_TRACE(shrinkage);
    Mask small(23, 17);
    for (std::uint8_t& pixel : small) pixel = random() % 3 == 0 ? 255 : 0;
    Mask mask(23 * shrinkage, 17 * shrinkage);
    EXPECT_TRUE(add_enlarged(small, shrinkage, mask));
    const auto at = [&](int x, int y) {
      return static_cast<double>(small(std::clamp(x, 0, 22), std::clamp(y, 0, 16)));
    };
    for (int y = 0; y < mask.height(); ++y) {
      for (int x = 0; x < mask.width(); ++x) {
        const double u = (x + 0.5) / shrinkage - 0.5;
        const double v = (y + 0.5) / shrinkage - 0.5;
        const int column = static_cast<int>(std::floor(u));
        const int row = static_cast<int>(std::floor(v));
        const double right = u - column;
        const double below = v - row;
        const double value =
            (1 - below) * ((1 - right) * at(column, row) + right * at(column + 1, row)) +
            below * ((1 - right) * at(column, row + 1) + right * at(column + 1, row + 1));
        if (std::abs(value - 127.5) < 0.01) continue;
        EXPECT_EQ(mask(x, y), value > 127.5 ? 255 : 0) << x << " " << y;
      }
    }
  }
  Mask empty(5, 5);
  Mask mask(20, 20);
  EXPECT_FALSE(add_enlarged(empty, 4, mask));
}

}  // namespace
}  // namespace diminish
