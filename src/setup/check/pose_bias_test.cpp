#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "core/text.h"
#include "diminish/setup_check.h"
#include "paths.h"
#include "temporary_folder.h"
#include "truth_poses.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;

std::string line_of(double stamp_s, const RigidTransform& world_from_camera) {
  const Eigen::Quaterniond q(world_from_camera.rotation);
  const Eigen::Vector3d& t = world_from_camera.translation;
  return fmt::format("{:.6f} {} {} {} {} {} {} {}\n", stamp_s, t.x(), t.y(), t.z(), q.x(), q.y(),
                     q.z(), q.w());
}

/// What is replaced in a file.
struct WrongNumber {
  std::string from, to;
};

/// A bundled recording with a tracker's poses: the truth's, the colour camera's moved by `wrong` as
/// a tracker that is mounted otherwise than was measured has them. No marker is left to say so.
/// number: of the colour camera in rig.yaml.
SetupReport check_with_poses(const RigidTransform& wrong, const char* name,
                             const WrongNumber& number = {}) {
  const fs::path source = fs::path(testing::recordings_dir()) / name;
  const TemporaryFolder copy;
  fs::copy(source, copy.path(), fs::copy_options::recursive);
  const Recording original = load_recording(source);
  const auto frames = open_recording(original, Options{});
  const TruthPoses truth(source);
  std::string color;
  std::vector<std::string> rgbd(original.rig.rgbd.size());
  FrameSet frame;
  for (std::size_t i = 0; frames->next(frame); ++i) {
    const Poses poses = truth.poses(i, original.rig);
    color += line_of(frame.stamp_s, (wrong * *poses.color_from_world).inverse());
    for (std::size_t k = 0; k < rgbd.size(); ++k)
      rgbd[k] += line_of(frame.rgbd[k].depth_stamp_s, poses.depth_from_world[k]->inverse());
  }
  copy.write("color_poses.txt", color);
  std::string files = "color: color_poses.txt";
  for (std::size_t k = 0; k < rgbd.size(); ++k) {
    const std::string file = original.rig.rgbd[k].name + "_poses.txt";
    copy.write(file, rgbd[k]);
    files += ", " + original.rig.rgbd[k].name + ": " + file;
  }
  std::string rig = read_text_file(source / "rig.yaml", 1 << 20);
  rig.replace(rig.find(number.from), number.from.size(), number.to);
  copy.write("rig.yaml", rig + "pose: {source: file, files: {" + files + "}}\n");
  copy.write("scene.yaml",
             "world_marker: {id: 7, size_m: 0.2}\noccluders:\n  - {name: box, detector: box, "
             "frame: world, "
             "min: [0.2, -0.4, 0.5], max: [0.6, 0, 0.7]}\n");
  const Recording recording = load_recording(copy.path());
  return check_setup(recording.rig, recording.scene, *open_recording(recording, Options{}));
}

TEST(CheckPoseBias, FindsATrackerThatIsMountedOtherwise) {
  constexpr double angle = 0.015;
  const Eigen::Vector3d axis = Eigen::Vector3d(0.2, -1, 0.6).normalized();
  const SetupReport report =
      check_with_poses({Eigen::AngleAxisd(angle, axis).toRotationMatrix(), {0, 0, 0}}, "workbench");
  ASSERT_EQ(report.findings.size(), 1U) << setup_report_text(report);
  EXPECT_EQ(report.findings[0].code, "pose-bias");
  EXPECT_THAT(report.findings[0].what, ::testing::HasSubstr("camera's pose is"));
  EXPECT_THAT(report.findings[0].remedy, ::testing::StartsWith("measure again"));
  const auto turned = std::find_if(
      report.figures.begin(), report.figures.end(),
      [](const SetupFigure& figure) { return figure.name.starts_with("refinement turns"); });
  ASSERT_NE(turned, report.figures.end());
  EXPECT_NEAR(turned->value, angle * 180 / std::numbers::pi, 0.2);
}

/// The number that stands behind `text` in what was measured.
double number_after(const std::string& text, const Finding& finding) {
  const std::size_t at = finding.figure.find(text);
  if (at == std::string::npos) return std::nan("");
  return std::stod(finding.figure.substr(at + text.size()));
}

TEST(CheckPoseBias, TellsAWrongFocalLengthFromAWrongPose) {
  const SetupReport report =
      check_with_poses({}, "workbench", {"[1131.4, 1130.7,", "[1165.3, 1164.6,"});
  ASSERT_EQ(report.findings.size(), 1U) << setup_report_text(report);
  const Finding& finding = report.findings[0];
  EXPECT_EQ(finding.code, "pose-bias");
  EXPECT_THAT(finding.what, ::testing::HasSubstr("camera's focal length is")) << finding.figure;
  EXPECT_THAT(finding.remedy, ::testing::StartsWith("diminish calibrate intrinsics"));
  EXPECT_NEAR(number_after("focal length of ", finding), 1131.4, 12);
}

TEST(CheckPoseBias, TellsAWrongDistortionFromAWrongPose) {
  const SetupReport report =
      check_with_poses({}, "calendar", {"distortion: [-0.11,", "distortion: [-0.31,"});
  ASSERT_EQ(report.findings.size(), 1U) << setup_report_text(report);
  const Finding& finding = report.findings[0];
  EXPECT_EQ(finding.code, "pose-bias");
  EXPECT_THAT(finding.what, ::testing::HasSubstr("camera's distortion is")) << finding.figure;
  EXPECT_NEAR(number_after("distortion coefficient of ", finding), -0.11, 0.04);
}

// The world marker is nowhere, but nobody needs it.
TEST(CheckPoseBias, TruePosesGiveNoFinding) {
  for (const char* name : {"calendar", "ball", "workbench"}) {
    const SetupReport report = check_with_poses({}, name);
    EXPECT_TRUE(report.fine()) << name << setup_report_text(report);
  }
}

}  // namespace
}  // namespace diminish
