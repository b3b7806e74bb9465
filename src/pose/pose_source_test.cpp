#include "diminish/pose_source.h"

#include <gtest/gtest.h>

#include <clocale>
#include <fstream>
#include <locale>
#include <sstream>

#include "analytic_scene.h"
#include "pose/camera_poses.h"
#include "pose/depth_check.h"
#include "pose/marker_pose.h"
#include "pose/pose_list.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

void expect_near(const RigidTransform& a, const RigidTransform& b, double metres, double degrees) {
  EXPECT_LT((a.inverse().translation - b.inverse().translation).norm(), metres);
  EXPECT_LT(rotation_difference_deg(a.rotation, b.rotation), degrees);
}

class PoseSources : public ::testing::Test {
 protected:
  PoseSources() : frame({.has_box = false}, {{-0.45, 0.3, 0.9}}) {
    scene.marker_dictionary = "DICT_4X4_50";
    scene.world_marker = {0, 0.2};
  }

  /// The world marker's corners as a camera at `camera_from_world` sees them.
  static Marker see(int id, const RigidTransform& camera_from_marker, double size_m,
                    const Intrinsics& intrinsics) {
    Marker marker{id, {}};
    const auto points = marker_corners(size_m);
    for (std::size_t i = 0; i < 4; ++i) {
      marker.corners[i] = *Lens(intrinsics).project(camera_from_marker * points[i]);
    }
    return marker;
  }
  RigidTransform rgbd_color_from_world() const {
    return frame.rig.rgbd[0].color_from_depth * *frame.poses.depth_from_world[0];
  }
  Markers both_markers() const {
    return {{see(0, *frame.poses.color_from_world, 0.2, frame.rig.color)},
            {{see(0, rgbd_color_from_world(), 0.2, frame.rig.rgbd[0].color)}}};
  }
  Poses estimate(const Markers& markers) {
    Poses poses;
    CameraPoses(frame.rig, scene).estimate(frame.frame, markers, poses);
    return poses;
  }
  void configure(const std::string& source, const std::string& yaml) {
    frame.rig.pose_source = source;
    frame.rig.pose = Config::parse(yaml, folder.path() / "rig.yaml");
  }

  TemporaryFolder folder;
  AnalyticFrame frame;
  Scene scene;
};

TEST_F(PoseSources, MarkersGiveEveryCamerasPose) {
  const Poses poses = estimate(both_markers());
  ASSERT_TRUE(poses.color_from_world && poses.depth_from_world[0] && poses.color_from_depth[0]);
  expect_near(*poses.color_from_world, *frame.poses.color_from_world, 1e-4, 0.01);
  expect_near(*poses.depth_from_world[0], *frame.poses.depth_from_world[0], 1e-4, 0.01);
  expect_near(*poses.color_from_depth[0], *frame.poses.color_from_depth[0], 2e-4, 0.02);
  EXPECT_TRUE(poses.messages.empty());
}

TEST_F(PoseSources, AMarkerThatIsNotSeenIsSaidSoAndLeavesThePoseOpen) {
  Markers markers = both_markers();
  markers.rgbd[0].clear();
  const Poses poses = estimate(markers);
  EXPECT_TRUE(poses.color_from_world);
  EXPECT_FALSE(poses.depth_from_world[0]);
  EXPECT_FALSE(poses.color_from_depth[0]);
  ASSERT_EQ(poses.messages.size(), 1U);
  EXPECT_EQ(poses.messages[0], "world marker 0 not visible in rgbd0");
}

// The corners fit both planar solutions equally well; the depth image tells which plane it is.
TEST_F(PoseSources, DepthSettlesThePlanarAmbiguity) {
  const RigidTransform truth = rgbd_color_from_world();
  const auto exact = estimate_marker_pose(see(0, truth, 0.2, frame.rig.rgbd[0].color).corners, 0.2,
                                          Lens(frame.rig.rgbd[0].color));
  ASSERT_TRUE(exact);
  const Lens depth_lens(frame.rig.rgbd[0].depth);
  const RigidTransform depth_from_color = frame.rig.rgbd[0].color_from_depth.inverse();
  const auto right = marker_depth_error_m(depth_from_color * exact->camera_from_marker, 0.2,
                                          depth_lens, frame.frame.rgbd[0].depth, 0.0001);
  const auto wrong = marker_depth_error_m(depth_from_color * exact->alternative, 0.2, depth_lens,
                                          frame.frame.rgbd[0].depth, 0.0001);
  ASSERT_TRUE(right && wrong);
  EXPECT_LT(*right, 0.002);
  EXPECT_GT(*wrong, 0.005);
}

TEST_F(PoseSources, FixedPosesAreTheConfigurations) {
  configure("fixed",
            "{source: fixed, color_from_rgbd: {rgbd0: {rotation: [1, 0, 0, 0, 0, -1, 0, 1, 0], "
            "translation: [0.1, 0.2, 0.3]}}}");
  const Poses poses = estimate({{}, {{}}});
  ASSERT_TRUE(poses.color_from_depth[0]);
  EXPECT_TRUE((*poses.color_from_depth[0] * Eigen::Vector3d(1, 2, 3))
                  .isApprox(Eigen::Vector3d(1.1, -2.8, 2.3)));
  EXPECT_FALSE(poses.color_from_world);
}

TEST_F(PoseSources, FixedPosesThatAreMissingOrTooManyAreErrors) {
  for (const char* yaml :
       {"{source: fixed}", "{source: fixed, color_from_rgbd: {}}",
        "{source: fixed, color_from_rgbd: {rgbd7: {rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1], "
        "translation: [0, 0, 0]}}}",
        "{source: fixed, color_from_rgbd: {rgbd0: {rotation: [1, 0, 0, 0, 1, 0, 0, 0, 0], "
        "translation: [0, 0, 0]}}}"}) {
    configure("fixed", yaml);
    EXPECT_THROW(CameraPoses(frame.rig, scene), Error) << yaml;
  }
  configure("sextant", "{source: sextant}");
  EXPECT_THROW(CameraPoses(frame.rig, scene), Error);
}

TEST_F(PoseSources, PosesFromFilesAreTheNearestInTime) {
  const auto write = [&](const char* name, const RigidTransform& camera_from_world) {
    const RigidTransform pose = camera_from_world.inverse();
    const Eigen::Quaterniond q(pose.rotation);
    std::ofstream file(folder.path() / name);
    file.precision(12);
    file << "# timestamp tx ty tz qx qy qz qw\n9.9 0 0 0 0 0 0 1\n10.001";
    for (const double value : {pose.translation.x(), pose.translation.y(), pose.translation.z(),
                               q.x(), q.y(), q.z(), q.w()}) {
      file << ' ' << value;
    }
    file << "\n10.2 0 0 0 0 0 0 1\n";
  };
  write("color_poses.txt", *frame.poses.color_from_world);
  write("rgbd0_poses.txt", *frame.poses.depth_from_world[0]);
  configure("file", "{source: file, files: {color: color_poses.txt, rgbd0: rgbd0_poses.txt}}");
  frame.frame.stamp_s = 10.0;
  frame.frame.rgbd[0].depth_stamp_s = 10.005;
  const Poses poses = estimate({{}, {{}}});
  ASSERT_TRUE(poses.color_from_depth[0]);
  expect_near(*poses.color_from_depth[0], *frame.poses.color_from_depth[0], 1e-9, 1e-6);

  frame.frame.rgbd[0].depth_stamp_s = 10.1;
  const Poses none = estimate({{}, {{}}});
  EXPECT_FALSE(none.color_from_depth[0]);
  ASSERT_EQ(none.messages.size(), 1U);
  EXPECT_EQ(none.messages[0], "no pose of rgbd0 within 0.02 s of 10.100000");
}

TEST(PoseList, NamesTheLineThatIsWrong) {
  const auto message = [](const std::string& text) -> std::string {
    std::istringstream stream(text);
    try {
      read_pose_list(stream, "poses.txt");
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_EQ(message(good), "no error");
  EXPECT_EQ(message(good + "2 0 0 0 0 0 0\n"),
            "poses.txt:2: expected 'timestamp tx ty tz qx qy qz qw'");
  EXPECT_EQ(message(good + "\n2 0 0 nan 0 0 0 1\n"), "poses.txt:3: expected a finite number");
  EXPECT_EQ(message(good + "2 0 x 0 0 0 0 1\n"), "poses.txt:2: expected a finite number");
  EXPECT_EQ(message(good + good), "poses.txt:2: expected ascending timestamps");
  EXPECT_EQ(message("1 0 0 0 0 0 0 0\n"), "poses.txt:1: expected a quaternion of length 1");
  EXPECT_EQ(message("# nothing\n"), "poses.txt: expected at least one pose");
  EXPECT_EQ(message(good + "2 0 1e308 0 0 0 0 1\n"),
            "poses.txt:2: expected metres, got more than a kilometre");
}

// A program that shows its user's language sets the locale for the whole process. No machine need
// have one with a decimal comma: this one is C++'s own.
TEST(PoseList, NumbersDoNotFollowTheLocale) {
  struct DecimalComma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_NUMERIC, name) != nullptr) break;  // strtod's
  }
  std::istringstream stream("1234.5 0.25 -1.5e-1 1000 0 0 0 1\n");
  const auto poses = read_pose_list(stream, "poses.txt");
  std::locale::global(before);
  std::setlocale(LC_NUMERIC, "C");
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].stamp_s, 1234.5);
  EXPECT_EQ(poses[0].world_from_camera.translation, Eigen::Vector3d(0.25, -0.15, 1000));
}

}  // namespace
}  // namespace diminish
