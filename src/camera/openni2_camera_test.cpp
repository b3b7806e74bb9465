// Goes through the real OpenNI2, with a driver that serves a recording (test/openni2_driver/).

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

#include "core/text.h"
#include "diminish/camera_source.h"
#include "diminish/config.h"
#include "diminish/frame_source.h"
#include "expect_error.h"
#include "paths.h"
#include "run_program.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const std::filesystem::path folder = std::filesystem::path(testing::recordings_dir()) / "calendar";

class OpenNi2Camera : public ::testing::Test {
 protected:
  OpenNi2Camera() { setenv("DIMINISH_TEST_RECORDING", folder.c_str(), 1); }
  std::unique_ptr<CameraSource> open(const std::string& uri, const Rig& rig) const {
    return open_camera("openni2:" + uri, {"rgbd0", &rig, 0});
  }

  Recording recording_ = load_recording(folder);
};

TEST_F(OpenNi2Camera, IsListed) {
  const auto devices = Registry<CameraSource>::get("openni2").list();
  ASSERT_THAT(devices, SizeIs(1));
  EXPECT_EQ(devices[0].uri, "openni2:test-recording");
  EXPECT_EQ(devices[0].description, "diminish recording");
}

TEST_F(OpenNi2Camera, DeliversTheDevicesImages) {
  std::vector<FrameSet> recorded;
  const auto source = open_recording(recording_, {});
  for (FrameSet frame; source->next(frame);) recorded.push_back(frame);

  const auto camera = open("test-recording", recording_.rig);
  int colors = 0;
  int depths = 0;
  std::array<double, 2> last_s{};
  for (int i = 0; i < 600 && (colors < 5 || depths < 5); ++i) {
    CameraImage image;
    if (camera->read(image, milliseconds(100)) != CameraSource::Status::image) continue;
    const bool is_depth = image.sensor == Sensor::depth;
    ++(is_depth ? depths : colors);
    EXPECT_TRUE(std::any_of(recorded.begin(), recorded.end(), [&](FrameSet& frame) {
      return is_depth ? frame.rgbd[0].depth.own() == image.depth
                      : frame.rgbd[0].color.own() == image.color;
    })) << (is_depth ? "depth" : "colour");
    EXPECT_GT(image.stamp_s, last_s[is_depth ? 1 : 0]);
    EXPECT_LE(image.stamp_s, monotonic_now_s());
    EXPECT_GT(image.stamp_s, monotonic_now_s() - 5);
    last_s[is_depth ? 1 : 0] = image.stamp_s;
  }
  EXPECT_GE(colors, 5);
  EXPECT_GE(depths, 5);
}

TEST_F(OpenNi2Camera, KnowsTheFactoryIntrinsics) {
  const auto intrinsics = open("", recording_.rig)->intrinsics(Sensor::depth);
  ASSERT_TRUE(intrinsics);
  const Intrinsics& depth = recording_.rig.rgbd[0].depth;
  EXPECT_EQ(intrinsics->width, depth.width);
  // The test driver says 1 and 0.8 radians.
  EXPECT_NEAR(2 * std::atan(depth.width / (2 * intrinsics->fx)), 1.0, 1e-5);
  EXPECT_NEAR(2 * std::atan(depth.height / (2 * intrinsics->fy)), 0.8, 1e-5);
}

TEST_F(OpenNi2Camera, FactoryIntrinsicsAreWrittenToTheRig) {
  const TemporaryFolder made;
  made.write("rig.yaml", "# my rig\n");
  const std::string file = (made.path() / "rig.yaml").string();
  const auto outcome = Program::run({"calibrate", "factory", "openni2:", "--out", file});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Config camera = Config::load(file).at("rgbd").items().at(0);
  EXPECT_EQ(camera.at("name").text(), "rgbd0");
  const RgbdCamera& truth = recording_.rig.rgbd[0];
  for (const auto& [sensor, size] :
       {std::pair{"color", truth.color}, std::pair{"depth", truth.depth}}) {
    EXPECT_EQ(camera.at(sensor).at("width").integer(1, 10000), size.width);
    EXPECT_EQ(camera.at(sensor).at("height").integer(1, 10000), size.height);
    const auto matrix = camera.at(sensor).at("camera_matrix").numbers(4);
    EXPECT_NEAR(2 * std::atan(size.width / (2 * matrix[0])), 1.0, 1e-4);
  }
  EXPECT_THAT(read_text_file(file, 10000), HasSubstr("# my rig\n"));

  const auto none = Program::run({"calibrate", "factory", "clock:openni2:", "--out", file});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("clock:openni2:: its driver does not know"));
}

TEST_F(OpenNi2Camera, ComplaintsSayWhatIsMissing) {
  EXPECT_THAT(error_of([&] { open("no-such-device", recording_.rig); }),
              HasSubstr("openni2:no-such-device"));
  Rig other = recording_.rig;
  other.rgbd[0].depth.width = 640;
  EXPECT_THAT(error_of([&] { open("", other); }),
              HasSubstr("the depth sensor has no mode of the rig's 640x"));
  EXPECT_THAT(error_of([&] {
                open_camera("openni2:", {"color", &other, 0});
              }),
              HasSubstr("expected to be used for an RGB-D camera"));
}

}  // namespace
}  // namespace diminish
