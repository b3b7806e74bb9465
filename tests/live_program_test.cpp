#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "diminish/frame_source.h"
#include "paths.h"
#include "run_program.h"

namespace diminish {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

const std::string calendar = testing::recordings_dir() + "/calendar";

TEST(LiveProgram, RunsAndRecordsWhatCanBeRunAgain) {
  const TemporaryFolder folder;
  const std::string copy = (folder.path() / "copy").string();
  const auto live = Program::run({"live", calendar, "--seconds", "4", "--record", copy});
  EXPECT_EQ(live.exit_code, 0) << live.err;
  EXPECT_THAT(live.out, AllOf(HasSubstr("frames/s"), HasSubstr("Latency: p50"),
                              ContainsRegex("Recorded [1-9][0-9]* frames")));
  const auto run = Program::run({"run", copy, "--out", (folder.path() / "out").string()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

/// Nobody could tidy up.
TEST(LiveProgram, ARecordingThatIsKilledIsRepaired) {
  const TemporaryFolder folder;
  const std::filesystem::path copy = folder.path() / "copy";
  const std::string replay = "recording:" + calendar + "?loop&rate=0.5";
  Program program({"live", calendar, "--color", replay, "--rgbd", replay, "--record", copy});
  for (int i = 0; i < 600 && !std::filesystem::exists(copy / "color/000003.jpg"); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  kill(program.process(), SIGKILL);
  EXPECT_EQ(program.wait().exit_code, 128 + SIGKILL);
  const auto repaired = Program::run({"repair", copy});
  EXPECT_EQ(repaired.exit_code, 0) << repaired.err;
  EXPECT_THAT(repaired.out, ContainsRegex("color.txt: [3-9][0-9]* entries"));
  const auto run = Program::run({"run", copy, "--out", (folder.path() / "out").string()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

/// From cameras to a picture without writing a line of YAML.
TEST(LiveProgram, BeginsASetUp) {
  const TemporaryFolder folder;
  const std::string desk = (folder.path() / "desk").string();
  const std::string replay = "recording:" + calendar + "?loop&rate=0.3";
  const std::vector<std::string> init = {"init", desk, "--color", replay, "--rgbd", replay};
  const auto begun = Program::run(init);
  EXPECT_EQ(begun.exit_code, 0) << begun.err;
  EXPECT_THAT(begun.out, AllOf(ContainsRegex("rgbd0 .*color 1920x1080.*depth 512x424"),
                               HasSubstr("diminish serve " + desk)));
  const auto live = Program::run({"live", desk, "--seconds", "4"});
  EXPECT_EQ(live.exit_code, 0) << live.err;
  EXPECT_THAT(live.out, HasSubstr("frames/s"));
  const auto again = Program::run(init);
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("rig.yaml: exists already"));
}

TEST(LiveProgram, AFrameBudgetAndFaultyCamerasAreShown) {
  const std::string faulty = "faults:torn=0.3;recording:" + calendar + "?loop";
  const auto live = Program::run(
      {"live", calendar, "--seconds", "3", "--color", faulty, "--rgbd", "rgbd0=" + faulty});
  EXPECT_EQ(live.exit_code, 0) << live.err;
  EXPECT_THAT(live.out, ContainsRegex("color +[0-9]+ +[0-9]+ +0 +0 +0 +[1-9]"));
}

TEST(LiveProgram, ARecordingThatIsNotLoopedEndsByItself) {
  const std::string once = "recording:" + calendar;
  const auto live = Program::run({"live", calendar, "--color", once, "--rgbd", once});
  EXPECT_EQ(live.exit_code, 0) << live.err;
}

TEST(LiveProgram, MeasuresLatencyThroughEverything) {
  const auto test = Program::run({"latency-test", calendar, "--seconds", "3"});
  EXPECT_EQ(test.exit_code, 0) << test.err;
  EXPECT_THAT(test.out, AllOf(ContainsRegex("to a viewer, decompressed +[0-9]"),
                              HasSubstr(" 0 without a readable time")));
}

TEST(LiveProgram, ChecksLiveCameras) {
  const std::string replay = "recording:" + calendar + "?loop&rate=0.3";
  const auto fine = Program::run(
      {"check", calendar, "--color", replay, "--rgbd", replay, "--seconds", "3", "--frames", "8"});
  EXPECT_THAT(fine.out, ContainsRegex("color: side of marker 0 +14[0-9]\\."));
  // A busy machine misses images of a camera, and is told so. It is told of nothing else.
  if (fine.out.find("[warning] no-partner") == std::string::npos) {
    EXPECT_EQ(fine.exit_code, 0) << fine.out << fine.err;
    EXPECT_THAT(fine.out, ContainsRegex("[1-8] frames: no problems found"));
  } else {
    EXPECT_THAT(fine.out, ContainsRegex("[1-8] frames: 1 finding\n"));
  }
  const auto gone = Program::run({"check", calendar, "--color", replay, "--rgbd",
                                  "recording:/nowhere", "--seconds", "3", "--frames", "8"});
  EXPECT_EQ(gone.exit_code, 3) << gone.err;
  EXPECT_THAT(gone.out, ContainsRegex("frames have no images of rgbd0"));
}

TEST(LiveProgram, ASyncCheckNamesTheCameraThatIsNotThere) {
  const std::string replay = "recording:" + calendar + "?loop";
  const auto check = Program::run({"sync-check", calendar, "--seconds", "4", "--color", replay,
                                   "--rgbd", "recording:/nowhere"});
  EXPECT_EQ(check.exit_code, 3);
  EXPECT_THAT(check.out, ContainsRegex("rgbd0 +/nowhere"));
}

TEST(LiveProgram, ListsCameras) {
  const auto devices = Program::run({"devices"});
  EXPECT_EQ(devices.exit_code, 0);
  EXPECT_THAT(devices.out, AllOf(HasSubstr("v4l2:/dev/video0"), HasSubstr("recording:FOLDER")));
}

TEST(LiveProgram, WithoutADisplayTheWindowSaysSo) {
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"}) unsetenv(name);
  const auto view = Program::run({"view", calendar});
  EXPECT_EQ(view.exit_code, 1);
  EXPECT_THAT(view.err, HasSubstr("there is no display"));
}

TEST(LiveProgram, WrongCamerasAreErrors) {
  const auto complaint = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"live", calendar});
    const auto live = Program::run(arguments);
    EXPECT_EQ(live.exit_code, 1);
    return live.err;
  };
  EXPECT_THAT(complaint({"--rgbd", "recording:x"}), HasSubstr("--color: expected a camera"));
  EXPECT_THAT(complaint({"--color", "x:y", "--rgbd", "recording:x"}),
              HasSubstr("unknown kind of camera 'x'"));
  EXPECT_THAT(
      complaint({"--color", "recording:x", "--rgbd", "recording:x", "--rgbd", "recording:x"}),
      HasSubstr("the rig has only 1 RGB-D cameras"));
  EXPECT_THAT(complaint({"--virtual-camera", "/dev/null/no"}), HasSubstr("/dev/null/no"));
}

}  // namespace
}  // namespace diminish
