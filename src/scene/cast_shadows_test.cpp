#include "scene/cast_shadows.h"

#include <gtest/gtest.h>

#include "lit_wall.h"

namespace diminish {
namespace {

class Lamps : public ::testing::Test, protected testing::LitWall {};

TEST_F(Lamps, ShadowsAreThoseOfTheRayCaster) {
  CastShadows shadows(rig.color);
  shadows.find({plane}, samples, box_points);
  ASSERT_TRUE(shadows.any());
  Reconstruction reconstruction = wall();
  Surfaces surfaces = wall_surfaces();
  shadows.shade(reconstruction, surfaces);
  testing::AnalyticScene empty = scene;
  empty.has_box = false;
  double error = 0;
  double error_without = 0;
  int count = 0;
  const Rect bounds = shadows.bounds();
  empty.render(Lens(rig.color), color_from_world,
               [&](int x, int y, const testing::AnalyticScene::Hit& hit) {
                 const double truth = light_at(hit.point);
                 error += std::abs(surfaces.light(x, y).g / 255.0 - truth);
                 error_without += 1 - truth;
                 ++count;
                 if (truth < 0.9) {
                   EXPECT_TRUE(bounds.contains(x, y)) << x << ' ' << y;
                 }
               });
  ASSERT_GT(error_without / count, 0.015);
  // Directions are 13 to 22 degrees apart, and the cells 2 cm.
  EXPECT_LT(error, 0.45 * error_without) << error / count;
}

TEST_F(Lamps, WhatStandsOnThePlaneKeepsItsLight) {
  CastShadows shadows(rig.color);
  shadows.find({plane}, samples, box_points);
  Reconstruction reconstruction = wall();
  Surfaces surfaces = wall_surfaces();
  const Lens lens(rig.color);
  for (int y = 0; y < rig.color.height; ++y) {
    for (int x = 0; x < rig.color.width; ++x) {
      const Eigen::Vector2f ray = lens.undistort({x, y}).cast<float>();
      reconstruction.depth_m(x, y) = 1 / plane.inverse_depth(ray.x(), ray.y()) - 0.06F;
    }
  }
  shadows.shade(reconstruction, surfaces);
  for (const Bgr& light : surfaces.light) ASSERT_EQ(light, (Bgr{255, 255, 255}));
}

TEST_F(Lamps, WithoutLampsOrObjectThereIsNone) {
  CastShadows shadows(rig.color);
  shadows.find({plane}, samples, {});
  EXPECT_FALSE(shadows.any());
  lamps[0].second = lamps[1].second = 0;
  sample_wall();
  shadows.find({plane}, samples, box_points);
  EXPECT_FALSE(shadows.any());
  EXPECT_TRUE(shadows.bounds().empty());
}

}  // namespace
}  // namespace diminish
