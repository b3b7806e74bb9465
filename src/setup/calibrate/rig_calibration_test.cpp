#include "diminish/rig_calibration.h"

#include <fmt/printf.h>
#include <gmock/gmock.h>

#include <cmath>

#include "diminish/frame_source.h"
#include "expect_error.h"
#include "paths.h"
#include "rendered_targets.h"
#include "truth_poses.h"

namespace diminish {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A colour camera and an RGB-D camera that do not move; markers and boards are shown to them.
class Bench {
 public:
  Bench() {
    rig.color = {640, 512, 566, 565, 322, 254, {-0.11, 0.09, 0.0006, -0.0004, 0}};
    RgbdCamera camera;
    camera.name = "rgbd0";
    camera.color = {960, 540, 530, 530.5, 478.5, 270.5, {0.041, -0.045, -0.0003, 0.0005, 0}};
    camera.depth = {256, 212, 183, 183, 127.5, 103, {0.0893, -0.268, 0, 0, 0.089}};
    camera.depth_unit_m = 0.001;
    camera.color_from_depth.rotation =
        Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    camera.color_from_depth.translation = {0.052, -0.006, -0.0113};
    rig.rgbd.push_back(camera);
    color_from_depth.rotation =
        Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.1, -1, 0.2).normalized()).toRotationMatrix();
    color_from_depth.translation = {0.31, 0.04, 0.08};
    scene.world_marker = {0, 0.2};
  }

  /// The colour camera is the world.
  FrameSet frame(const std::vector<testing::Target>& targets, unsigned seed,
                 const RigidTransform& moved = {}) const {
    const RgbdCamera& camera = rig.rgbd[0];
    const RigidTransform depth_from_world = color_from_depth.inverse() * moved;
    FrameSet frame;
    frame.color = testing::TargetRenderer(rig.color).color(targets, {}, 0.6, 2, seed);
    frame.rgbd.resize(1);
    frame.rgbd[0].color =
        testing::TargetRenderer(camera.color)
            .color(targets, camera.color_from_depth * depth_from_world, 0.6, 2, seed + 1000);
    frame.rgbd[0].depth =
        testing::TargetRenderer(camera.depth)
            .depth(targets, depth_from_world, camera.depth_unit_m, 0.002, seed + 2000);
    return frame;
  }

  Rig rig;
  Scene scene;
  RigidTransform color_from_depth;  ///< the truth
};

/// A target held in front of the cameras, tilted by `lean` radians.
RigidTransform held(int index, double lean) {
  const double direction = 2.4 * index;
  RigidTransform pose;
  pose.rotation =
      Eigen::AngleAxisd(lean, Eigen::Vector3d(std::cos(direction), std::sin(direction), 0))
          .toRotationMatrix() *
      Eigen::Vector3d(1, -1, -1).asDiagonal();
  pose.translation = {0.17 * (index % 3 - 1) + 0.05, 0.13 * (index / 3 % 3 - 1),
                      0.85 + 0.07 * (index % 4)};
  return pose;
}

double distance_mm(const RigidTransform& a, const RigidTransform& b) {
  return 1000 * (a.translation - b.translation).norm();
}

/// A transform that is off by some millimetres and a degree.
RigidTransform nudged(RigidTransform transform) {
  transform.rotation =
      Eigen::AngleAxisd(0.02, Eigen::Vector3d(-2, 1, 0.7).normalized()).toRotationMatrix() *
      transform.rotation;
  transform.translation += Eigen::Vector3d(0.008, -0.006, 0.011);
  return transform;
}

TEST(RigCalibration, FindsTheCamerasOfASyntheticBenchByAMarker) {
  const Bench bench;
  RigCalibration calibration(bench.rig, bench.scene, std::nullopt);
  for (int i = 0; i < 10; ++i) {
    calibration.add(
        bench.frame({testing::marker_target(0, 0.2, held(i, 0.5))}, static_cast<unsigned>(i)));
  }
  const ColorFromRgbd result = calibration.color_from_rgbd(0, bench.rig.rgbd[0].color_from_depth);
  EXPECT_THAT(result.warnings, IsEmpty());
  EXPECT_GE(result.sightings, 8U);
  const double degrees =
      rotation_difference_deg(result.color_from_depth.rotation, bench.color_from_depth.rotation);
  RecordProperty("figures",
                 fmt::sprintf("marker: %.2f mm, %.3f degrees (sd %.2f mm, %.3f degrees), %.3f px",
                              distance_mm(result.color_from_depth, bench.color_from_depth), degrees,
                              1000 * result.deviation_m, result.deviation_deg, result.error_px));
  EXPECT_LT(distance_mm(result.color_from_depth, bench.color_from_depth), 3);
  EXPECT_LT(degrees, 0.15);
  EXPECT_LT(result.error_px, 0.3);
}

// Half the markers are where the other camera does not see them: a robust fit takes no notice.
TEST(RigCalibration, IsNotLedAstrayBySomeWrongSightings) {
  const Bench bench;
  RigCalibration calibration(bench.rig, bench.scene, std::nullopt);
  for (int i = 0; i < 10; ++i) {
    FrameSet frame =
        bench.frame({testing::marker_target(0, 0.2, held(i, 0.5))}, static_cast<unsigned>(i));
    if (i % 3 == 2) {
      // The colour camera's picture is of another moment.
      frame.color = bench.frame({testing::marker_target(0, 0.2, held(i + 1, 0.4))}, 77).color;
    }
    calibration.add(frame);
  }
  const ColorFromRgbd result = calibration.color_from_rgbd(0, bench.rig.rgbd[0].color_from_depth);
  EXPECT_EQ(result.agreeing, 7U);
  EXPECT_LT(distance_mm(result.color_from_depth, bench.color_from_depth), 4);
}

TEST(RigCalibration, SaysThatCamerasMovedAgainstEachOther) {
  const Bench bench;
  RigCalibration calibration(bench.rig, bench.scene, std::nullopt);
  for (int i = 0; i < 6; ++i) {
    RigidTransform moved;
    moved.translation = {0.01 * i, 0, 0};
    calibration.add(bench.frame({testing::marker_target(0, 0.2, held(0, 0.4))},
                                static_cast<unsigned>(i), moved));
  }
  EXPECT_THAT(calibration.color_from_rgbd(0, bench.rig.rgbd[0].color_from_depth).warnings,
              Contains(HasSubstr("moved against each other")));
}

TEST(RigCalibration, FindsTheDepthSensorByABoardThatLeansInAllDirections) {
  const Bench bench;
  const Board board = parse_board("checkerboard:7x5:40");
  Rig rig = bench.rig;
  rig.rgbd[0].color_from_depth = nudged(bench.rig.rgbd[0].color_from_depth);
  RigCalibration calibration(rig, bench.scene, board);
  for (int i = 0; i < 9; ++i) {
    calibration.add(
        bench.frame({testing::board_target(board, held(i, 0.55))}, static_cast<unsigned>(i)));
  }
  const DepthToColor result = calibration.depth_to_color(0);
  EXPECT_THAT(result.undetermined, IsEmpty());
  EXPECT_THAT(result.warnings, IsEmpty());
  const RigidTransform& truth = bench.rig.rgbd[0].color_from_depth;
  const double degrees = rotation_difference_deg(result.color_from_depth.rotation, truth.rotation);
  RecordProperty(
      "figures_2",
      fmt::sprintf(
          "depth to colour: %.2f mm, %.3f degrees (sd %.2f mm), planes off by %.2f mm, were "
          "%.2f mm, %zu boards",
          distance_mm(result.color_from_depth, truth), degrees, 1000 * result.deviation_m,
          1000 * result.error_m, 1000 * result.error_before_m, result.sightings));
  // Where the boards were.
  const Eigen::Vector3d at_boards(0, 0, 1);
  const double there_mm = 1000 * (result.color_from_depth * at_boards - truth * at_boards).norm();
  RecordProperty("figures_3", fmt::sprintf("at the boards' place: %.2f mm", there_mm));
  EXPECT_LT(there_mm, 2);
  EXPECT_LT(degrees, 0.35);
  EXPECT_LT(result.error_m, 0.001);
  EXPECT_GT(result.error_before_m, 0.005);

  const ColorFromRgbd between = calibration.color_from_rgbd(0, truth);
  EXPECT_LT(distance_mm(between.color_from_depth, bench.color_from_depth), 2);
}

// Boards that all face the camera determine its distance and tilt: three of six degrees of freedom.
TEST(RigCalibration, SaysWhatParallelPlanesDoNotDetermine) {
  const Bench bench;
  const Board board = parse_board("checkerboard:7x5:40");
  Rig rig = bench.rig;
  rig.rgbd[0].color_from_depth.translation += Eigen::Vector3d(0.01, 0.01, 0.01);
  RigCalibration calibration(rig, bench.scene, board);
  for (int i = 0; i < 6; ++i) {
    calibration.add(
        bench.frame({testing::board_target(board, held(i, 0.02))}, static_cast<unsigned>(i)));
  }
  const DepthToColor result = calibration.depth_to_color(0);
  EXPECT_EQ(result.undetermined.size(), 3U);
  EXPECT_THAT(result.undetermined, Contains("shift along x"));
  EXPECT_THAT(result.undetermined, Contains("shift along y"));
  EXPECT_THAT(result.undetermined, Contains("rotation about z"));
  EXPECT_THAT(result.warnings, Contains(HasSubstr("3 of 6")));
  // Along the line of sight it is found all the same.
  EXPECT_NEAR(result.color_from_depth.translation.z(),
              bench.rig.rgbd[0].color_from_depth.translation.z(), 0.003);
}

TEST(RigCalibration, SaysWhichCameraSawNothing) {
  const Bench bench;
  RigCalibration calibration(bench.rig, bench.scene, std::nullopt);
  calibration.add(bench.frame({}, 1));
  EXPECT_THAT(error_of([&] { calibration.depth_to_color(0); }), HasSubstr("rgbd0"));
  EXPECT_THAT(error_of([&] { calibration.color_from_rgbd(0, {}); }), HasSubstr("rgbd0"));
  EXPECT_THAT(error_of([&] { RigCalibration(bench.rig, Scene{}, std::nullopt); }),
              HasSubstr("--board"));
}

// In the demo recordings the user's camera moves by some millimetres a frame: a single frame has
// one transform, which the truth says; all frames have none.
TEST(RigCalibration, AgreesWithTheTruthOfADemoRecording) {
  for (const char* name : {"calendar", "workbench"}) {
    const std::filesystem::path folder = std::filesystem::path(testing::recordings_dir()) / name;
    const Recording recording = load_recording(folder);
    const auto source = open_recording(recording, Options{});
    const TruthPoses truth(folder);
    FrameSet frame;
    ASSERT_TRUE(source->next(frame));
    RigCalibration calibration(recording.rig, recording.scene, std::nullopt);
    calibration.add(frame);
    const Poses poses = truth.poses(0, recording.rig);
    for (std::size_t k = 0; k < recording.rig.rgbd.size(); ++k) {
      const ColorFromRgbd result =
          calibration.color_from_rgbd(k, recording.rig.rgbd[k].color_from_depth);
      // At the scene, 1.5 m away.
      const Eigen::Vector3d world(0.2, -0.2, 0);
      const Eigen::Vector3d in_depth = *poses.depth_from_world[k] * world;
      const double error_mm =
          1000 *
          (result.color_from_depth * in_depth - *poses.color_from_depth[k] * in_depth).norm();
      RecordProperty(std::string(name) + "_" + recording.rig.rgbd[k].name,
                     fmt::sprintf("%s %s: %.1f mm at the scene, %.2f degrees, %.2f px", name,
                                  recording.rig.rgbd[k].name.c_str(), error_mm,
                                  rotation_difference_deg(result.color_from_depth.rotation,
                                                          poses.color_from_depth[k]->rotation),
                                  result.error_px));
      EXPECT_LT(error_mm, 12);
      EXPECT_LT(rotation_difference_deg(result.color_from_depth.rotation,
                                        poses.color_from_depth[k]->rotation),
                1.0);
    }
  }
}

}  // namespace
}  // namespace diminish
