// With Cyclone DDS, another implementation with another compiler of IDL: its programs (tests/ros2/)
// know ROS's definitions of the messages and nothing of diminish.

#include <gmock/gmock.h>

#include <filesystem>

#include "background_program.h"
#include "camera_node_arguments.h"
#include "cyclone_environment.h"
#include "diminish/camera_source.h"
#include "diminish/frame_source.h"
#include "paths.h"
#include "ros2_domain.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::filesystem::path folder = std::filesystem::path(testing::recordings_dir()) / "calendar";

class Ros2Cyclone : public ::testing::Test {
 protected:
  std::string receive(const std::string& kind, const std::string& topic) const {
    const auto outcome =
        Program({domain_.text(), kind, topic}, beside_the_program("cyclone_receiver")).wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  }

  const CycloneEnvironment environment_;
  Ros2Domain domain_;
};

TEST_F(Ros2Cyclone, ItsCameraIsRead) {
  const BackgroundProgram sender({domain_.text(), "/camera"}, beside_the_program("cyclone_sender"));
  const auto camera = open_camera("ros2:/camera?color=color/image_raw&depth=depth/image_raw&tf",
                                  {"rgbd0", nullptr, 0});
  CameraImage color, depth, image;
  for (const double end_s = monotonic_now_s() + 30;
       monotonic_now_s() < end_s &&
       (color.color.empty() || depth.depth.empty() || !camera->color_from_depth());) {
    if (camera->read(image, milliseconds(100)) != CameraSource::Status::image) continue;
    EXPECT_EQ(image.fault, "");
    std::swap(image, image.sensor == Sensor::color ? color : depth);
  }
  ASSERT_EQ(color.color.width(), 64);
  ASSERT_EQ(color.color.height(), 48);
  for (std::size_t i = 0; i < color.color.size(); ++i) {
    const auto value = static_cast<std::uint8_t>(i % 251);
    ASSERT_EQ(color.color.data()[i], (Bgr{value, value, value})) << i;
  }
  ASSERT_EQ(depth.depth.size(), 64U * 48);
  for (std::size_t i = 0; i < depth.depth.size(); ++i) ASSERT_EQ(depth.depth.data()[i], 500 + i);
  EXPECT_NEAR(color.stamp_s, monotonic_now_s(), 30);

  ASSERT_TRUE(camera->intrinsics(Sensor::color));
  const Intrinsics expected{.width = 64,
                            .height = 48,
                            .fx = 61,
                            .fy = 62,
                            .cx = 31.5,
                            .cy = 23.5,
                            .distortion = {.1, -.05, .001, -.002, .01}};
  EXPECT_EQ(*camera->intrinsics(Sensor::color), expected);
  ASSERT_TRUE(camera->intrinsics(Sensor::depth));
  EXPECT_EQ(camera->intrinsics(Sensor::depth)->fx, 55);

  ASSERT_TRUE(camera->color_from_depth());
  EXPECT_TRUE(camera->color_from_depth()->translation.isApprox(Eigen::Vector3d(.05, -.01, .002)));
  // The quaternion (0, 0, 0.6, 0.8): 2 atan(0.6 / 0.8) about z.
  EXPECT_NEAR(camera->color_from_depth()->rotation(1, 0), 2 * .6 * .8, 1e-12);
}

TEST_F(Ros2Cyclone, ItReadsACameraNode) {
  const Recording recording = load_recording(folder);
  const RgbdCamera& camera = recording.rig.rgbd[0];
  const BackgroundProgram node(camera_node_arguments(folder));
  EXPECT_THAT(receive("info", "/rgbd0/depth/camera_info"),
              StartsWith(std::to_string(camera.depth.width) + "x" +
                         std::to_string(camera.depth.height) + " plumb_bob d 5 fx "));
  EXPECT_THAT(receive("compressed", "/rgbd0/color/image_raw/compressed"),
              StartsWith("color_optical_frame 'bgr8; jpeg compressed bgr8' bytes "));
  EXPECT_THAT(receive("compressed", "/rgbd0/depth/image_raw/compressedDepth"),
              StartsWith("depth_optical_frame '16UC1; compressedDepth rvl' bytes "));
}

TEST_F(Ros2Cyclone, ItReadsTheResult) {
  const BackgroundProgram session(
      {"live", folder.string(), "--ros2", "/diminish", "--seconds", "60"});
  const Recording recording = load_recording(folder);
  const std::string size =
      std::to_string(recording.rig.color.width) + "x" + std::to_string(recording.rig.color.height);
  EXPECT_THAT(receive("info", "/diminish/camera_info"), StartsWith(size));
  EXPECT_THAT(receive("diagnostics", "/diagnostics"),
              HasSubstr("diminish: camera rgbd0: running, "));
}

}  // namespace
}  // namespace diminish
