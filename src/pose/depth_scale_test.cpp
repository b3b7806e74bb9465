#include "pose/depth_scale.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pose/marker_pose.h"

namespace diminish {
namespace {

constexpr double size_m = 0.2;
constexpr int world = 3;

/// A marker on a wall, seen by an RGB-D camera whose sensors are in one place.
class DepthScaleTest : public ::testing::Test {
 protected:
  DepthScaleTest() {
    RgbdCamera camera;
    camera.name = "rgbd0";
    camera.color = {.width = 640, .height = 480, .fx = 500, .fy = 500, .cx = 320, .cy = 240};
    camera.depth = {.width = 320, .height = 240, .fx = 250, .fy = 250, .cx = 160, .cy = 120};
    camera.depth_unit_m = 0.001;
    rig.color = camera.color;
    rig.rgbd.push_back(camera);
    scene.world_marker = {world, size_m};
    frame.rgbd.resize(1);
    frame.rgbd[0].color.own().resize(640, 480, Bgr{0, 0, 0});
    frame.rgbd[0].depth.own().resize(320, 240, 0);
    markers.rgbd.resize(1);
    stand_at(1);
  }

  /// The wall is frontal: of one depth.
  void stand_at(double distance_m) {
    Marker marker;
    marker.id = world;
    const auto corners = marker_corners(size_m);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      marker.corners[i] = {320 + 500 * corners[i].x() / distance_m,
                           240 - 500 * corners[i].y() / distance_m};
    }
    markers.rgbd[0] = {marker};
    frame.rgbd[0].depth.own().fill(static_cast<std::uint16_t>(std::lround(1000 * distance_m)));
  }
  std::optional<MarkerScale> find() {
    std::vector<std::optional<MarkerScale>> found;
    DepthScale(rig, scene).find(frame, markers, found);
    return found.at(0);
  }

  Rig rig;
  Scene scene;
  FrameSet frame;
  Markers markers;
};

TEST_F(DepthScaleTest, IsOneWhereAllFits) {
  for (const double distance_m : {0.6, 1., 2.2}) {
    stand_at(distance_m);
    const auto found = find();
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->ratio, 1, 0.003);
    EXPECT_EQ(found->marker, world);
  }
}

TEST_F(DepthScaleTest, TellsUnitSizeAndFocalLength) {
  rig.rgbd[0].depth_unit_m = 0.0002;
  EXPECT_NEAR(find()->ratio, 0.2, 0.001);
  rig.rgbd[0].depth_unit_m = 0.001;
  scene.world_marker.size_m = 1.1 * size_m;
  EXPECT_NEAR(find()->ratio, 1 / 1.1, 0.003);
  scene.world_marker.size_m = size_m;
  rig.rgbd[0].color.fx = rig.rgbd[0].color.fy = 1.12 * 500;
  EXPECT_NEAR(find()->ratio, 1 / 1.12, 0.003);
}

TEST_F(DepthScaleTest, IsUnknownWithoutMarkerOrDepth) {
  stand_at(4);  // 25 pixels wide
  EXPECT_FALSE(find());
  stand_at(1);
  frame.rgbd[0].depth.own().fill(0);
  EXPECT_FALSE(find());
  stand_at(1);
  scene.world_marker.id = world + 1;
  EXPECT_FALSE(find());
  stand_at(1);
  rig.rgbd[0].measures_depth = false;
  EXPECT_FALSE(find());
}

// A hand over half of the marker, which is still found.
TEST_F(DepthScaleTest, ThingsInFrontAreNoWrongScale) {
  Image<std::uint16_t>& depth = frame.rgbd[0].depth.own();
  scene.world_marker.id = world;
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      depth.row(y)[x] = static_cast<std::uint16_t>(700 + 3 * std::abs(x - 160));
    }
  }
  EXPECT_FALSE(find());
}

}  // namespace
}  // namespace diminish
