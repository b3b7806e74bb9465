#include "depth/camera_choice.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace diminish {
namespace {

/// A wall at 2 m in front of the user, an object in the middle of the picture, and cameras beside
/// the user that look straight ahead.
struct Wall {
  explicit Wall(const std::vector<double>& places_m) {
    rig.color = {.width = 640, .height = 480, .fx = 500, .fy = 500, .cx = 319.5, .cy = 239.5};
    masks.color.resize(640, 480, 0);
    masks.color.fill(objects, 255);
    for (const double x_m : places_m) {
      RgbdCamera camera;
      camera.name = "rgbd" + std::to_string(rig.rgbd.size());
      camera.color =
          camera.depth = {.width = 128, .height = 96, .fx = 100, .fy = 100, .cx = 63.5, .cy = 47.5};
      rig.rgbd.push_back(camera);
      RgbdFrame& images = frame.rgbd.emplace_back();
      images.color.own().resize(128, 96, {});
      images.depth.own().resize(128, 96, 2000);
      RigidTransform user_from_camera;
      user_from_camera.translation.x() = x_m;
      poses.color_from_depth.emplace_back(user_from_camera);
      masks.rgbd_depth.emplace_back(128, 96, std::uint8_t{0});
    }
  }

  std::vector<bool> spared() { return CameraChoice(rig).find_spared(frame, poses, masks, objects); }

  Rect objects = {200, 150, 240, 180};
  Rig rig;
  FrameSet frame;
  Poses poses;
  OcclusionMasks masks;
};

TEST(CameraChoice, OneOfManyThatSeeTheSameIsEnough) {
  Wall wall({0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1});
  const std::vector<bool> spared = wall.spared();
  EXPECT_EQ(std::count(spared.begin(), spared.end(), false), 1);
}

TEST(CameraChoice, TakesTheOneThatLooksMostLikeTheUser) {
  Wall wall({-1, 0.05, 0.9});
  EXPECT_EQ(wall.spared(), (std::vector<bool>{true, false, true}));
}

TEST(CameraChoice, TakesWhatOnlyOneCameraSees) {
  Wall wall({0.05, -0.5, -0.5});
  // The first sees nothing of the right half: its depth is missing there.
  for (int y = 0; y < 96; ++y) {
    for (int x = 62; x < 128; ++x) wall.frame.rgbd[0].depth.own()(x, y) = 0;
  }
  const std::vector<bool> spared = wall.spared();
  EXPECT_FALSE(spared[0]);
  EXPECT_NE(spared[1], spared[2]);
}

TEST(CameraChoice, AnOldImageIsWorthLess) {
  Wall wall({0.1, 0.1, 0.1});
  wall.frame.stamp_s = 10;
  for (RgbdFrame& images : wall.frame.rgbd) images.depth_stamp_s = 9.5;
  wall.frame.rgbd[2].depth_stamp_s = 9.99;
  EXPECT_EQ(wall.spared(), (std::vector<bool>{true, true, false}));
}

TEST(CameraChoice, ObjectsHideWhatIsBehindThem) {
  Wall wall({0, 0.5, 0.6});
  wall.masks.rgbd_depth[0].fill(255);
  EXPECT_EQ(wall.spared(), (std::vector<bool>{true, false, true}));
}

TEST(CameraChoice, TwoCamerasAreBothDrawn) {
  Wall wall({0.1, 0.1});
  EXPECT_EQ(wall.spared(), (std::vector<bool>{false, false}));
}

TEST(CameraChoice, CamerasWithoutAPoseOrDepthAreNotItsBusiness) {
  Wall wall({0.1, 0.1, 0.1});
  wall.poses.color_from_depth[0].reset();
  wall.rig.rgbd[1].measures_depth = false;
  EXPECT_EQ(wall.spared(), (std::vector<bool>{false, false, false}));
}

}  // namespace
}  // namespace diminish
