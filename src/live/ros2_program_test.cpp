// Several processes of diminish on the loopback.

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "background_program.h"
#include "camera_node_arguments.h"
#include "dds/dds.h"
#include "diminish/camera_source.h"
#include "diminish/frame_source.h"
#include "paths.h"
#include "ros2_domain.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

const std::filesystem::path calendar = testing::recordings / "calendar";

class Ros2Program : public ::testing::Test {
 protected:
  /// Waits for an image of the sensor.
  static CameraImage next_image(CameraSource& camera, Sensor sensor) {
    CameraImage image;
    for (const double end_s = monotonic_now_s() + 30; monotonic_now_s() < end_s;) {
      if (camera.read(image, milliseconds(100)) == CameraSource::Status::image &&
          image.sensor == sensor) {
        return image;
      }
    }
    ADD_FAILURE() << "no image";
    return image;
  }

  /// The mean of the green channel's.
  static double difference(const Image<Bgr>& a, const Image<Bgr>& b) {
    if (a.size() != b.size()) return 255;
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a.data()[i].g - b.data()[i].g);
    return sum / static_cast<double>(a.size());
  }

  Ros2Domain domain_;
  Recording recording_ = load_recording(calendar);
};

TEST_F(Ros2Program, ANodesImagesAreTheLocalCameras) {
  std::vector<FrameSet> recorded;
  const auto source = open_recording(recording_, {});
  for (FrameSet frame; source->next(frame);) recorded.push_back(frame);

  const BackgroundProgram node(camera_node_arguments(calendar));
  const auto camera = open_camera("ros2:/rgbd0", {"rgbd0", &recording_.rig, 0});
  int depths = 0;
  int colors = 0;
  int pairs = 0;
  double color_stamp_s = 0;
  double depth_stamp_s = 0;
  CameraImage image;
  for (const double end_s = monotonic_now_s() + 30;
       monotonic_now_s() < end_s && (depths < 5 || colors < 5 || pairs < 1);) {
    if (camera->read(image, milliseconds(100)) != CameraSource::Status::image) continue;
    EXPECT_EQ(image.fault, "");
    if (image.sensor == Sensor::depth) {  // lossless
      ++depths;
      depth_stamp_s = image.stamp_s;
      if (std::abs(depth_stamp_s - color_stamp_s) < .001) ++pairs;
      EXPECT_TRUE(std::any_of(recorded.begin(), recorded.end(), [&](FrameSet& frame) {
        return frame.rgbd[0].depth.own() == image.depth;
      }));
      continue;
    }
    ++colors;
    color_stamp_s = image.stamp_s;
    // Either may come first.
    if (std::abs(depth_stamp_s - color_stamp_s) < .001) ++pairs;
    double least = 255;
    for (FrameSet& frame : recorded) {
      least = std::min(least, difference(image.color, frame.rgbd[0].color.own()));
    }
    EXPECT_LT(least, 3);
  }
  EXPECT_GE(depths, 5);
  EXPECT_GE(colors, 5);
  EXPECT_GE(pairs, 1);
  const auto unknown = open_camera("ros2:/rgbd0", {"rgbd0", nullptr, 0});
  next_image(*unknown, Sensor::depth);
  EXPECT_NEAR(unknown->intrinsics(Sensor::color)->fx, recording_.rig.rgbd[0].color.fx, 1e-9);
  EXPECT_NEAR(unknown->intrinsics(Sensor::depth)->fx, recording_.rig.rgbd[0].depth.fx, 1e-9);
  EXPECT_TRUE(unknown->color_from_depth()->translation.isApprox(
      recording_.rig.rgbd[0].color_from_depth.translation, 1e-9));
}

TEST_F(Ros2Program, AKilledNodeIsBackWhenItIsStartedAgain) {
  auto node = std::make_unique<BackgroundProgram>(camera_node_arguments(calendar));
  const auto camera = open_camera("ros2:/rgbd0", {"rgbd0", &recording_.rig, 0});
  next_image(*camera, Sensor::depth);
  node->kill_now();
  CameraImage image;
  while (camera->read(image, milliseconds(300)) == CameraSource::Status::image) {
  }
  const double started_s = monotonic_now_s();
  node = std::make_unique<BackgroundProgram>(camera_node_arguments(calendar));
  next_image(*camera, Sensor::depth);
  RecordProperty("seconds_until_back", std::to_string(monotonic_now_s() - started_s));
}

TEST_F(Ros2Program, ALiveSessionRunsOnNodesAndPublishesItsResult) {
  const BackgroundProgram node(camera_node_arguments(calendar));
  const BackgroundProgram session({"live", calendar.string(), "--color",
                                   "recording:" + calendar.string() + "?loop", "--rgbd",
                                   "ros2:/rgbd0", "--ros2", "/diminish", "--seconds", "60"});
  const auto result = open_camera("ros2:/diminish?color=image", {"color", nullptr, 0});
  const CameraImage picture = next_image(*result, Sensor::color);
  EXPECT_EQ(picture.fault, "");
  EXPECT_EQ(picture.color.width(), recording_.rig.color.width);
  for (int i = 0; i < 300 && !result->intrinsics(Sensor::color); ++i) {
    next_image(*result, Sensor::color);
  }
  ASSERT_TRUE(result->intrinsics(Sensor::color));
  EXPECT_NEAR(result->intrinsics(Sensor::color)->fx, recording_.rig.color.fx, 1e-9);
  const auto mask = open_camera("ros2:/diminish?color=mask", {"color", nullptr, 0});
  int most = 0;
  for (int i = 0; i < 100 && most == 0; ++i) {
    const CameraImage image = next_image(*mask, Sensor::color);
    for (const Bgr pixel : image.color) most = std::max<int>(most, pixel.g);
  }
  EXPECT_EQ(most, 255);
}

TEST_F(Ros2Program, InitWritesWhatTheNodeTells) {
  const BackgroundProgram node(camera_node_arguments(calendar));
  const BackgroundProgram eye({"camera-node", "recording:" + calendar.string() + "?loop", "--topic",
                               "/eye", "--name", "color", "--rig", calendar.string()});
  const TemporaryFolder out;
  const std::string made = (out.path() / "desk").string();
  const auto outcome =
      Program::run({"init", made, "--color", "ros2:/eye", "--rgbd", "ros2:/rgbd0"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Rig rig = load_rig(std::filesystem::path(made) / "rig.yaml");
  EXPECT_NEAR(rig.color.fx, recording_.rig.color.fx, .01);
  ASSERT_EQ(rig.rgbd.size(), 1U);
  EXPECT_NEAR(rig.rgbd[0].depth.fx, recording_.rig.rgbd[0].depth.fx, .01);
  EXPECT_TRUE(rig.rgbd[0].color_from_depth.translation.isApprox(
      recording_.rig.rgbd[0].color_from_depth.translation, 1e-5));
}

TEST_F(Ros2Program, WrongUseIsOneLine) {
  for (const auto& [arguments, what] :
       {std::pair{std::vector<std::string>{"camera-node", "v4l2:/dev/video0", "--topic", "a b"},
                  "expected a topic such as"},
        {{"camera-node", "recording:x", "--topic", "/a", "--rig", calendar.string(), "--name", "x"},
         "the rig has no camera 'x'"},
        {{"live", calendar.string(), "--ros2", "/a?interfaces=1", "--seconds", "1"},
         "unknown parameter 'interfaces'"}}) {
    const auto outcome = Program::run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr(what));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

}  // namespace
}  // namespace diminish
