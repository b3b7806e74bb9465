#include "render/color_ray.h"

#include <gtest/gtest.h>

namespace diminish {
namespace {

const Intrinsics sensor{64, 48, 50, 50, 31.5, 23.5, {}};

/// By how much the ray at a pixel differs from the pixel's own, in pixels, with columns and rows
/// of `hole` without depth.
Eigen::Vector2f shift(const Rect& hole, int column, int row) {
  Image<std::uint16_t> depth(sensor.width, sensor.height, std::uint16_t{1000});
  depth.fill(hole, 0);
  const RayTable rays(sensor);
  return (color_ray(depth, rays, column, row) - rays(column, row)) * 50;
}

TEST(ColorRay, IsFurtherFromHoles) {
  for (const int width : {1, 2, 9}) {
    const Rect hole{30, 0, width, 48};
    EXPECT_TRUE(shift(hole, 29, 20).isApprox(Eigen::Vector2f(-0.6F, 0), 1e-4F));
    EXPECT_TRUE(shift(hole, 30 + width, 20).isApprox(Eigen::Vector2f(0.6F, 0), 1e-4F));
    EXPECT_EQ(shift(hole, 28, 20).norm(), 0);
    EXPECT_EQ(shift(hole, 31 + width, 20).norm(), 0);
    EXPECT_TRUE(shift({0, 30, 64, width}, 20, 29).isApprox(Eigen::Vector2f(0, -0.6F), 1e-4F));
    EXPECT_TRUE(
        shift({0, 30, 64, width}, 20, 30 + width).isApprox(Eigen::Vector2f(0, 0.6F), 1e-4F));
  }
}

TEST(ColorRay, IsThePixelsOwnElsewhere) {
  EXPECT_EQ(shift({30, 0, 3, 48}, 0, 20).norm(), 0) << "at the image's rim";
  EXPECT_EQ(shift({30, 10, 3, 3}, 29, 9).norm(), 0) << "at a corner of the hole";
  EXPECT_EQ(shift({1, 0, 2, 48}, 0, 20).norm(), 0) << "no pixel further away";
}

// Between two holes there is no better place.
TEST(ColorRay, IsThePixelsOwnBetweenHoles) {
  Image<std::uint16_t> depth(sensor.width, sensor.height, std::uint16_t{1000});
  depth.fill({30, 0, 1, 48}, 0);
  depth.fill({32, 0, 1, 48}, 0);
  const RayTable rays(sensor);
  EXPECT_EQ(color_ray(depth, rays, 31, 20), rays(31, 20));
}

}  // namespace
}  // namespace diminish
