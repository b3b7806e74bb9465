#include "setup/init/initial_setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diminish/config.h"
#include "diminish/pipeline.h"
#include "diminish/scene.h"
#include "diminish/validate.h"
#include "expect_error.h"
#include "paths.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

const std::string replay = "recording:" + testing::recordings_dir() + "/workbench?loop&rate=10";

TEST(InitialSetup, LooksAtCameras) {
  const Rig rig = load_rig(testing::recordings_dir() + "/workbench/rig.yaml");
  const FoundCamera color = look_at_camera(replay, "color");
  ASSERT_TRUE(color.color);
  EXPECT_TRUE(color.color_is_guess);
  EXPECT_EQ(color.color->width, rig.color.width);
  EXPECT_EQ(color.color->height, rig.color.height);
  EXPECT_NEAR(color.color->fx, rig.color.fx, 0.2 * rig.color.fx);
  const FoundCamera rgbd = look_at_camera(replay, "rgbd1");
  ASSERT_TRUE(rgbd.color && rgbd.depth);
  EXPECT_EQ(rgbd.depth->width, rig.rgbd[1].depth.width);
  EXPECT_THAT(error_of([] { look_at_camera("v4l2:/dev/video77", "color"); }),
              HasSubstr("v4l2:/dev/video77"));
}

/// What is written is what the program reads.
TEST(InitialSetup, WritesARigThatIsRead) {
  InitialRig initial;
  initial.color = look_at_camera(replay, "color");
  initial.color.uri = R"(gst:videotestsrc pattern="ball" ! videoconvert)";
  const FoundCamera both = look_at_camera(replay, "rgbd0");
  FoundCamera color = both;
  color.depth.reset();
  color.depth_is_guess = false;
  FoundCamera depth = both;
  depth.color.reset();
  initial.rgbd = {{"left", {both}}, {"right", {depth, color}}};
  const std::string yaml = initial_rig_yaml(initial);
  const Rig rig = read_rig(Config::parse(yaml, "rig.yaml"));
  EXPECT_EQ(rig.color, *initial.color.color);
  ASSERT_EQ(rig.rgbd.size(), 2u);
  EXPECT_EQ(rig.rgbd[1].name, "right");
  EXPECT_EQ(rig.rgbd[1].depth, *both.depth);
  EXPECT_EQ(rig.rgbd[1].color, *both.color);
  ASSERT_EQ(rig.live.size(), 4u);
  EXPECT_EQ(rig.live[0].name, "color");
  EXPECT_EQ(rig.live[0].uri, initial.color.uri);
  EXPECT_EQ(rig.live[3].name, "right");
  EXPECT_THAT(yaml, HasSubstr("a guess"));

  const Scene scene = read_scene(Config::parse(initial_scene_yaml(initial, 0.15), "scene.yaml"));
  EXPECT_NO_THROW(validate(scene, rig));
  EXPECT_EQ(scene.occluders.at(0).detector, "difference");
  EXPECT_EQ(scene.world_marker.size_m, 0.15);

  initial.rgbd = {{"left", {depth}}};
  EXPECT_THAT(error_of([&] { initial_rig_yaml(initial); }),
              HasSubstr("left: " + depth.uri + " delivers no color images"));
}

/// With two colour cameras beside the user's, with one, with none: what is written can be run.
TEST(InitialSetup, WithoutDepthTheSetupCanBeRun) {
  const std::string stereo = "recording:" + testing::recordings_dir() + "/stereo?loop&rate=10";
  InitialRig initial;
  initial.color = look_at_camera(stereo, "color");
  initial.color_only = {{"left", {look_at_camera(stereo, "left")}},
                        {"right", {look_at_camera(stereo, "right")}}};
  for (const std::size_t cameras : {2, 1, 0}) {
    SCOPED_TRACE(cameras);
    initial.color_only.resize(cameras);
    const Rig rig = read_rig(Config::parse(initial_rig_yaml(initial), "rig.yaml"));
    const Scene scene = read_scene(Config::parse(initial_scene_yaml(initial, 0.15), "scene.yaml"));
    ASSERT_EQ(rig.rgbd.size(), cameras);
    EXPECT_EQ(rig.live.size(), cameras + 1);
    for (const RgbdCamera& camera : rig.rgbd) EXPECT_FALSE(camera.measures_depth);
    EXPECT_NO_THROW(Pipeline(rig, scene, Options{}));
  }
}

TEST(InitialSetup, LiveCamerasOfARigAreChecked) {
  std::string yaml =
      "live: [{camera: rgbd3, uri: 'openni2:'}]\n"
      "color: {width: 64, height: 48, camera_matrix: [60, 60, 32, 24], distortion: [0, 0, 0, 0, "
      "0]}\nrgbd: []\n";
  EXPECT_THAT(error_of([&] { read_rig(Config::parse(yaml, "rig.yaml")); }),
              HasSubstr("rig.yaml:1: live[0].camera: expected one of color, got 'rgbd3'"));
}

}  // namespace
}  // namespace diminish
