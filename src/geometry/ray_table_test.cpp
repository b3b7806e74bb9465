#include "geometry/ray_table.h"

#include <gtest/gtest.h>

#include <thread>

namespace diminish {
namespace {

const Intrinsics depth{
    509, 424, 365.6, 365.6, 255.1, 206.3, {0.0893, -0.268, 0.0002, -0.0003, 0.089}};
const Intrinsics fisheye{
    640, 480, 330.1, 330.3, 322.7, 241.1, {-0.008, 0.045, -0.043, 0.008}, LensModel::fisheye};

TEST(RayTable, TheLensPutsEachRayOnItsPixel) {
  for (const Intrinsics& camera : {depth, fisheye}) {
    const RayTable rays(camera);
    ASSERT_EQ(rays.width(), camera.width);
    ASSERT_EQ(rays.height(), camera.height);
    const Lens lens(camera);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const auto pixel = lens.distort(rays(x, y).cast<double>());
        ASSERT_TRUE(pixel) << x << ' ' << y;
        ASSERT_LT((*pixel - Eigen::Vector2d(x, y)).norm(), 1e-4) << x << ' ' << y;
        ASSERT_EQ(rays.x(y)[x], rays(x, y).x());
        ASSERT_EQ(rays.y(y)[x], rays(x, y).y());
      }
      for (int x = camera.width; x % RayTable::block != 0; ++x) {
        ASSERT_EQ(rays.x(y)[x], 0) << x << ' ' << y;
        ASSERT_EQ(rays.y(y)[x], 0) << x << ' ' << y;
      }
    }
  }
}

TEST(RayTable, IsOneForAllWhoHoldIt) {
  const auto first = RayTable::of(depth);
  const auto other = RayTable::of(fisheye);
  EXPECT_EQ(RayTable::of(depth), first);
  EXPECT_NE(other, first);
  Intrinsics moved = depth;
  moved.cx += 1;
  const auto of_moved = RayTable::of(moved);
  EXPECT_NE(of_moved, first);
  EXPECT_NE((*of_moved)(0, 0), (*first)(0, 0));
}

TEST(RayTable, IsFreedWhenNobodyHoldsIt) {
  std::weak_ptr<const RayTable> seen = RayTable::of(depth);
  EXPECT_TRUE(seen.expired());
}

TEST(RayTable, ThreadsThatAskAtOnceGetTheSame) {
  std::shared_ptr<const RayTable> tables[4];
  {
    std::vector<std::jthread> threads;
    for (auto& table : tables) threads.emplace_back([&] { table = RayTable::of(fisheye); });
  }
  for (const auto& table : tables) EXPECT_EQ(table, tables[0]);
}

}  // namespace
}  // namespace diminish
