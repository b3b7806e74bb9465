#include "pose/pose_refinement.h"

#include <gtest/gtest.h>

#include "analytic_scene.h"
#include "scene/scene_sampler.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;

RigidTransform small_motion() {
  RigidTransform motion;
  motion.rotation =
      Eigen::AngleAxisd(0.008, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  motion.translation = {0.006, -0.004, 0.005};
  return motion;
}

class PoseRefinementTest : public ::testing::Test {
 protected:
  PoseRefinementTest()
      : frame({}, {Eigen::Vector3d(-0.45, 0.3, 0.9)}), masks(testing::empty_masks(frame.rig)) {}

  /// Mean distance in pixels between where the RGB-D camera and the colour camera see the same
  /// point.
  double error_px(const Poses& poses) const {
    const Lens lens(frame.rig.color);
    const RigidTransform moved =
        *poses.color_from_depth[0] * frame.poses.color_from_depth[0]->inverse();
    double sum = 0;
    int count = 0;
    for (int y = 20; y < 256; y += 20) {
      for (int x = 20; x < 320; x += 20) {
        const Eigen::Vector2d ray = lens.undistort(Eigen::Vector2d(x, y));
        const auto pixel = lens.project(moved * Eigen::Vector3d(1.2 * ray.homogeneous()));
        if (!pixel) continue;
        sum += (*pixel - Eigen::Vector2d(x, y)).norm();
        ++count;
      }
    }
    return sum / count;
  }
  bool refine(Poses& poses) {
    SceneSamples samples;
    SceneSampler(frame.rig).sample(frame.frame, poses, masks, samples);
    PoseRefinement refinement(frame.rig.color);
    const auto correction = refinement.refine(frame.frame, masks.color, samples);
    if (correction) refinement.apply(*correction, poses, samples);
    return correction.has_value();
  }

  AnalyticFrame frame;
  OcclusionMasks masks;
};

TEST_F(PoseRefinementTest, FindsBackToTheTruePose) {
  Poses poses = frame.poses;
  poses.color_from_depth[0] = small_motion() * *poses.color_from_depth[0];
  poses.color_from_world = small_motion() * *poses.color_from_world;
  const double before = error_px(poses);
  ASSERT_GT(before, 1.5);
  ASSERT_TRUE(refine(poses));
  EXPECT_LT(error_px(poses), before / 4);
  // Both move together: where the RGB-D camera is in the world has not changed.
  const RigidTransform depth_from_world =
      poses.color_from_depth[0]->inverse() * *poses.color_from_world;
  EXPECT_LT((depth_from_world.translation - frame.poses.depth_from_world[0]->translation).norm(),
            1e-9);
}

// As far as with steps as they come, in a picture of which the weights take long to settle.
TEST_F(PoseRefinementTest, FindsBackByFurtherSteps) {
  Poses poses = frame.poses;
  poses.color_from_depth[0] = small_motion() * *poses.color_from_depth[0];
  poses.color_from_world = small_motion() * *poses.color_from_world;
  const double before = error_px(poses);
  SceneSamples samples;
  SceneSampler(frame.rig).sample(frame.frame, poses, masks, samples);
  PoseRefinement refinement(frame.rig.color, {.extrapolates = true});
  const auto correction = refinement.refine(frame.frame, masks.color, samples);
  ASSERT_TRUE(correction);
  refinement.apply(*correction, poses, samples);
  EXPECT_LT(error_px(poses), before / 4);
}

// As far off as a tracker that was mounted by eye: nothing lies within its neighbourhood any more.
TEST_F(PoseRefinementTest, FindsBackFromFarByTheSmallestPictureFirst) {
  RigidTransform far;
  far.rotation = Eigen::AngleAxisd(0.028, Eigen::Vector3d(1, -2, 0.5).normalized()).matrix();
  Poses poses = frame.poses;
  poses.color_from_depth[0] = far * *poses.color_from_depth[0];
  poses.color_from_world = far * *poses.color_from_world;
  const double before = error_px(poses);
  SceneSamples samples;
  SceneSampler(frame.rig).sample(frame.frame, poses, masks, samples);
  const auto left_px = [&](int coarser) {
    PoseRefinement refinement(frame.rig.color, {.coarser = coarser});
    const auto correction = refinement.refine(frame.frame, masks.color, samples);
    Poses refined = poses;
    SceneSamples moved = samples;
    if (correction) refinement.apply(*correction, refined, moved);
    return error_px(refined);
  };
  EXPECT_GT(left_px(0), before / 2);
  EXPECT_LT(left_px(PoseRefinement::usual_coarser), before / 8);
}

TEST_F(PoseRefinementTest, FindsBackThroughEveryLens) {
  for (const LensModel model : {LensModel::rational, LensModel::fisheye}) {
    SCOPED_TRACE(name_of(model));
    frame = AnalyticFrame({}, {Eigen::Vector3d(-0.45, 0.3, 0.9)}, model);
    Poses poses = frame.poses;
    poses.color_from_depth[0] = small_motion() * *poses.color_from_depth[0];
    const double before = error_px(poses);
    ASSERT_GT(before, 1);
    ASSERT_TRUE(refine(poses));
    EXPECT_LT(error_px(poses), before / 4);
  }
}

// Gain and offset may differ between cameras.
TEST_F(PoseRefinementTest, DoesNotMindAnotherExposure) {
  for (Bgr& pixel : frame.frame.rgbd[0].color.own()) {
    pixel = {static_cast<std::uint8_t>(pixel.b / 2 + 30),
             static_cast<std::uint8_t>(pixel.g / 2 + 30),
             static_cast<std::uint8_t>(pixel.r / 2 + 30)};
  }
  Poses poses = frame.poses;
  poses.color_from_depth[0] = small_motion() * *poses.color_from_depth[0];
  const double before = error_px(poses);
  ASSERT_TRUE(refine(poses));
  EXPECT_LT(error_px(poses), before / 4);
}

// The object to remove must have no influence.
TEST_F(PoseRefinementTest, LooksOnlyOutsideTheMask) {
  masks.color.fill({60, 60, 120, 100}, 255);
  Poses poses = frame.poses;
  poses.color_from_depth[0] = small_motion() * *poses.color_from_depth[0];
  Poses again = poses;
  ASSERT_TRUE(refine(poses));
  for (int y = 60; y < 160; ++y) {
    for (int x = 60; x < 180; ++x) frame.frame.color.own()(x, y) = {255, 0, 255};
  }
  ASSERT_TRUE(refine(again));
  // The last pixels beside the mask are blurred with it.
  EXPECT_NEAR(error_px(poses), error_px(again), 0.05);
}

TEST_F(PoseRefinementTest, LeavesPosesAloneWhereThereIsNothingToSee) {
  frame.frame.color.own().resize(320, 256, {90, 90, 90});
  Poses poses = frame.poses;
  poses.color_from_depth[0] = small_motion() * *poses.color_from_depth[0];
  const double before = error_px(poses);
  refine(poses);
  EXPECT_NEAR(error_px(poses), before, 0.02);
}

}  // namespace
}  // namespace diminish
