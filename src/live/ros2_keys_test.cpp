// Programs that have keys, and such that have not.

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

#include "background_program.h"
#include "camera_node_arguments.h"
#include "diminish/camera_source.h"
#include "diminish/frame_source.h"
#include "paths.h"
#include "ros2_domain.h"
#include "setup/keys/keys.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

const std::filesystem::path folder = std::filesystem::path(testing::recordings_dir()) / "calendar";

class Ros2Keys : public ::testing::Test {
 protected:
  std::string made(const std::string& store, const std::string& name) const {
    return make_keys(store_.path() / store, {.names = {name}}).folders.at(0).string();
  }
  static bool has_image(CameraSource& camera, milliseconds timeout) {
    CameraImage image;
    return camera.read(image, timeout) == CameraSource::Status::image && image.fault.empty();
  }

  TemporaryFolder store_;
  Ros2Domain domain_;
  Recording recording_ = load_recording(folder);
};

TEST_F(Ros2Keys, ANodeWithKeysIsSeenByThoseWithKeysOnly) {
  const std::string camera_keys = made("store", "camera");
  const std::string user_keys = made("store", "user");
  const BackgroundProgram node(camera_node_arguments(folder, "?keys=" + camera_keys));
  const CameraRequest request{"rgbd0", &recording_.rig, 0};
  const auto user = open_camera("ros2:/rgbd0?keys=" + user_keys, request);
  const auto keyless = open_camera("ros2:/rgbd0", request);
  const auto stranger = open_camera("ros2:/rgbd0?keys=" + made("other", "user"), request);
  int images = 0;
  for (const double end_s = monotonic_now_s() + 60; images < 60 && monotonic_now_s() < end_s;) {
    images += has_image(*user, milliseconds(100)) ? 1 : 0;
    EXPECT_FALSE(has_image(*keyless, milliseconds(1)));
    EXPECT_FALSE(has_image(*stranger, milliseconds(1)));
  }
  EXPECT_EQ(images, 60);
}

TEST_F(Ros2Keys, TheProgramMakesThem) {
  const std::string store = (store_.path() / "lab").string();
  const auto outcome = Program::run({"keys", store, "camera_host", "--publish", "/rgbd0/*"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("keys=" + store + "/enclaves/camera_host\n"));
  const auto user = Program::run({"keys", store, "user_host"});
  ASSERT_EQ(user.exit_code, 0) << user.err;
  const BackgroundProgram node(
      camera_node_arguments(folder, "?keys=" + store + "/enclaves/camera_host"));
  const auto camera = open_camera("ros2:/rgbd0?keys=" + store + "/enclaves/user_host",
                                  {"rgbd0", &recording_.rig, 0});
  bool is_seen = false;
  for (int i = 0; i < 300 && !is_seen; ++i) is_seen = has_image(*camera, milliseconds(100));
  EXPECT_TRUE(is_seen);
}

TEST_F(Ros2Keys, WhatIsWrongIsOneLine) {
  std::filesystem::create_directories(store_.path() / "empty");
  const std::string empty = (store_.path() / "empty").string();
  for (const auto& [arguments, what] :
       {std::pair{camera_node_arguments(folder, "?keys=" + empty),
                  empty + "/identity_ca.cert.pem: cannot be read"},
        {camera_node_arguments(folder, "?keys"),
         "keys: expected a folder that `diminish keys` made"},
        {{"live", folder.string(), "--ros2", "/a?keys=" + empty, "--seconds", "1"},
         "identity_ca.cert.pem: cannot be read"},
        {{"keys", empty + "/x", "a b"}, "expected a name of letters"}}) {
    const auto outcome = Program::run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr(what));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

}  // namespace
}  // namespace diminish
