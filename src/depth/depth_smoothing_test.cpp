#include "depth/depth_smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace diminish {
namespace {

constexpr int width = 160;
constexpr int height = 120;

/// A slanted surface, and from column 80 on another one, `step` further away.
double exact(int x, int y, double step) {
  return 1500 + 2 * x + y + (x < 80 ? 0 : step);
}

/// Depths in mm, with noise.
Image<std::uint16_t> measured(double step, double noise) {
  Image<std::uint16_t> depth(width, height);
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, noise);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      depth(x, y) = static_cast<std::uint16_t>(std::lround(exact(x, y, step) + normal(random)));
    }
  }
  return depth;
}
Image<std::uint16_t> smoothed(const Image<std::uint16_t>& depth) {
  Image<std::uint16_t> result = depth;
  DepthSmoothing(0.001F).smooth(depth, depth, depth.bounds(), result);
  return result;
}

/// The root mean square of the errors in some columns, rims of the image aside.
double error(const Image<std::uint16_t>& depth, double step, int first, int last) {
  double sum = 0;
  for (int y = 8; y < height - 8; ++y) {
    for (int x = first; x < last; ++x) sum += std::pow(depth(x, y) - exact(x, y, step), 2);
  }
  return std::sqrt(sum / ((height - 16) * (last - first)));
}

// As many independent depths as windows hold would leave a seventh of it; a plane's slopes are
// found from them, too.
TEST(DepthSmoothing, TakesOutNoiseWhateverItsLevel) {
  for (const double noise : {1., 4., 12.}) {
    const Image<std::uint16_t> result = smoothed(measured(0, noise));
    EXPECT_LT(error(result, 0, 8, width - 8), 0.2 * noise + 0.3) << noise;
  }
}

// A step is told from noise by the noise that there is, not by a distance: 10 mm where depth is
// good to 1 mm, 60 mm where it is good to 6.
TEST(DepthSmoothing, LeavesStepsAbove10TimesTheNoise) {
  for (const double noise : {1., 6.}) {
    const double step = 10 * noise;
    const Image<std::uint16_t> depth = measured(step, noise);
    const Image<std::uint16_t> result = smoothed(depth);
    EXPECT_LT(error(result, step, 77, 83), 1.1 * error(depth, step, 77, 83)) << noise;
    EXPECT_LT(error(result, step, 8, 72), 0.2 * noise + 0.3) << noise;
    EXPECT_LT(error(result, step, 88, width - 8), 0.2 * noise + 0.3) << noise;
  }
}

TEST(DepthSmoothing, HolesStayAndLendNothing) {
  Image<std::uint16_t> depth = measured(0, 0);
  const Rect hole{40, 50, 3, 4};
  depth.fill(hole, 0);
  const Image<std::uint16_t> result = smoothed(depth);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (hole.contains(x, y)) {
        ASSERT_EQ(result(x, y), 0);
      } else {
        ASSERT_NEAR(result(x, y), depth(x, y), 1) << x << ' ' << y;
      }
    }
  }
}

// Also rows whose parts end in different columns.
TEST(DepthSmoothing, PartsAreLikeTheWhole) {
  const Image<std::uint16_t> depth = measured(50, 4);
  const Image<std::uint16_t> whole = smoothed(depth);
  DepthPart part;
  part.begin(8);
  for (int y = 0; y < height; y += 8) part.add_band({y / 2, width - y / 4}, y + 8);
  Image<std::uint16_t> result = depth;
  DepthSmoothing(0.001F).smooth(depth, depth, part, result);
  for (int y = 0; y < height; ++y) {
    const DepthPart::Columns& columns = part.columns(y);
    for (int x = 0; x < width; ++x) {
      if (x < columns.first || x >= columns.last) {
        ASSERT_EQ(result(x, y), depth(x, y)) << x << ' ' << y;
      } else {
        ASSERT_EQ(result(x, y), whole(x, y)) << x << ' ' << y;
      }
    }
  }
}

// Fewer pixels than a window; no depth at all.
TEST(DepthSmoothing, ImagesWithoutWindowsStay) {
  for (const auto& [columns, rows] : {std::pair{5, 40}, {40, 5}, {1, 1}}) {
    Image<std::uint16_t> depth(columns, rows, std::uint16_t{1000});
    EXPECT_EQ(smoothed(depth), depth);
  }
  const Image<std::uint16_t> none(width, height, std::uint16_t{0});
  EXPECT_EQ(smoothed(none), none);
}

}  // namespace
}  // namespace diminish
