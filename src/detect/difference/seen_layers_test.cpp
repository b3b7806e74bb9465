#include "detect/difference/seen_layers.h"

#include <gtest/gtest.h>

#include "analytic_scene.h"
#include "detect/difference/free_space.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

class SeenLayersTest : public ::testing::Test {
 protected:
  SeenLayersTest() {
    scene.box_min.z() = 0.5;
    scene.box_max.z() = 0.6;
  }

  /// z of the box's front and of the wall on the line of sight of a pixel; front 0: not the box.
  struct Truth {
    double front_m = 0, wall_m = 0;
  };
  Truth truth(const AnalyticFrame& now, int x, int y) const {
    const RigidTransform& color_from_world = *now.poses.color_from_world;
    const RigidTransform world_from_color = color_from_world.inverse();
    const Eigen::Vector3d direction =
        world_from_color.rotation *
        Lens(now.rig.color).undistort(Eigen::Vector2d(x, y)).homogeneous();
    AnalyticScene empty = scene;
    empty.has_box = false;
    const auto first = scene.cast(world_from_color.translation, direction);
    const auto wall = empty.cast(world_from_color.translation, direction);
    return {first.on_box ? (color_from_world * first.point).z() : 0,
            (color_from_world * wall.point).z()};
  }

  AnalyticScene scene;
  std::vector<ColorMap> maps = std::vector<ColorMap>(256);
};

/// Two cameras that look past the box from both sides see the box and all of the wall behind it.
TEST_F(SeenLayersTest, AreTheFirstAndTheLastSurface) {
  const AnalyticFrame now(scene, {{-0.55, 0.35, 1.1}, {0.6, 0.3, 1.0}});
  SeenLayersDrawer drawer(now.rig);
  ASSERT_EQ(drawer.shrinkage(), 1);
  SeenLayers layers;
  drawer.draw(now.frame, now.poses, maps, {0.05, 2}, layers);
  int on_box = 0;
  int past_box = 0;
  int wrong = 0;
  for (int y = 90; y < 165; ++y) {
    for (int x = 115; x < 200; ++x) {
      const auto [front_m, wall_m] = truth(now, x, y);
      const SeenSurface& nearest = layers.nearest(x, y);
      const SeenSurface& farthest = layers.farthest(x, y);
      if (front_m == 0 || nearest.source == 0) continue;
      ++on_box;
      if (std::abs(nearest.depth_m - front_m) > 0.02) ++wrong;
      if (farthest.depth_m < 1.2 * nearest.depth_m) continue;
      ++past_box;
      if (std::abs(farthest.depth_m - wall_m) > 0.02) ++wrong;
    }
  }
  EXPECT_GT(on_box, 3000);
  EXPECT_GT(past_box, on_box / 2);
  EXPECT_LT(wrong, on_box / 50);
}

TEST_F(SeenLayersTest, NothingIsFreeBehindASurfaceOrOutOfView) {
  scene.has_box = false;
  const AnalyticFrame now(scene, {{-0.3, 0.1, 1.1}});
  FreeSpace space(now.rig);
  space.begin(now.frame, now.poses);
  const Eigen::Vector2f ray(0, 0);  // to a wall at about 1.2 m
  EXPECT_TRUE(space.is_free(ray, 0.8F, 1.2F));
  EXPECT_FALSE(space.is_free(ray, 0.8F, 1.5F));
  EXPECT_FALSE(space.is_free(ray, 0.01F, 1.2F));  // begins beside the RGB-D camera's view
  AnalyticFrame late = now;
  late.frame.rgbd[0].missing = "late";
  space.begin(late.frame, late.poses);
  EXPECT_FALSE(space.is_free(ray, 0.8F, 1.2F));

  scene.has_box = true;  // in the way of the RGB-D camera's line of sight
  const AnalyticFrame hidden(scene, {{-0.3, 0.1, 1.1}});
  space.begin(hidden.frame, hidden.poses);
  EXPECT_FALSE(space.is_free(ray, 0.8F, 1.2F));
}

}  // namespace
}  // namespace diminish
