#include "live/session_diagnostics.h"

#include <gtest/gtest.h>

namespace diminish {
namespace {

using ros::DiagnosticStatus;

TEST(SessionDiagnostics, SayWhatIsWrongWhereItIs) {
  LiveStatus status;
  status.running = true;
  status.frames_per_second = 29.5;
  CameraStatus running, lost;
  running.name = "color";
  running.state = CameraState::running;
  running.problem = "an old one";
  lost.name = "rgbd0";
  lost.uri = "ros2:/rgbd0";
  lost.state = CameraState::lost;
  lost.problem = "the device is gone";
  lost.clock = CameraClock{.offset_s = .012, .drift = 3e-6, .is_trusted = true};
  status.cameras = {running, lost};
  auto array = diagnostics_of(status);
  ASSERT_EQ(array.statuses.size(), 3U);
  EXPECT_EQ(array.statuses[0].level, DiagnosticStatus::ok);
  EXPECT_EQ(array.statuses[0].message, "running");
  EXPECT_EQ(array.statuses[1].level, DiagnosticStatus::ok);
  EXPECT_EQ(array.statuses[1].message, "running");
  EXPECT_EQ(array.statuses[2].level, DiagnosticStatus::error);
  EXPECT_EQ(array.statuses[2].name, "diminish: camera rgbd0");
  EXPECT_EQ(array.statuses[2].hardware_id, "ros2:/rgbd0");
  EXPECT_EQ(array.statuses[2].message, "lost: the device is gone");
  EXPECT_EQ(array.statuses[2].values.back()[0], "clock drift ppm");
  EXPECT_EQ(array.statuses[2].values.back()[1], "3");

  status.problems = {"rgbd0 is lost", "no marker"};
  array = diagnostics_of(status);
  EXPECT_EQ(array.statuses[0].level, DiagnosticStatus::warn);
  EXPECT_EQ(array.statuses[0].message, "rgbd0 is lost; no marker");
}

}  // namespace
}  // namespace diminish
