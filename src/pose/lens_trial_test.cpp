#include "pose/lens_trial.h"

#include <gtest/gtest.h>

#include "analytic_scene.h"
#include "pose/marker_pose.h"
#include "scene/scene_sampler.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;

constexpr double marker_m = 0.15;

/// A wall that is seen obliquely, with the world marker in the middle.
class LensTrialTest : public ::testing::Test {
 protected:
  LensTrialTest()
      : frame({}, {Eigen::Vector3d(-0.45, 0.3, 0.9)}, LensModel::plumb_bob, {0.75, 0.1, 0.85}),
        masks(testing::empty_masks(frame.rig)) {
    scene.world_marker = {0, marker_m};
    Marker marker;
    const auto corners = marker_corners(marker_m);
    const Lens lens(frame.rig.color);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      marker.corners[i] = *lens.project(*frame.poses.color_from_world * corners[i]);
    }
    markers.color = {marker};
  }

  /// What is found where the focal length is said to be this much of what it is.
  std::optional<double> find(double said) {
    Rig rig = frame.rig;
    rig.color.fx *= said;
    rig.color.fy *= said;
    Poses measured = frame.poses;
    if (rig.pose_source == "marker") {
      measured.color_from_world =
          estimate_marker_pose(markers.color[0].corners, marker_m, Lens(rig.color))
              ->camera_from_marker;
      measured.color_from_depth[0] =
          *measured.color_from_world * frame.poses.depth_from_world[0]->inverse();
    }
    SceneSamples samples;
    SceneSampler(rig).sample(frame.frame, measured, masks, samples);
    PoseRefinement refinement(rig.color, {.coarser = PoseRefinement::usual_coarser});
    refinement.refine(frame.frame, masks.color, samples);
    return LensTrial(rig, scene).find(markers, measured, refinement);
  }

  AnalyticFrame frame;
  OcclusionMasks masks;
  Scene scene;
  Markers markers;
};

TEST_F(LensTrialTest, FindsNothingBetterThanTheRightLens) {
  EXPECT_FALSE(find(1));
  EXPECT_FALSE(find(0.99));
  EXPECT_FALSE(find(1.01));
}

TEST_F(LensTrialTest, SaysWhichWayAFocalLengthIsWrong) {
  for (const double said : {0.88, 0.92, 0.95}) EXPECT_EQ(find(said), 1 + LensTrial::step) << said;
  for (const double said : {1.05, 1.08, 1.12}) EXPECT_EQ(find(said), 1 - LensTrial::step) << said;
}

// A tracker's poses do not change with the lens.
TEST_F(LensTrialTest, HoldsOtherPosesForRight) {
  frame.rig.pose_source = "file";
  EXPECT_FALSE(find(1));
  EXPECT_EQ(find(0.95), 1 + LensTrial::step);
  EXPECT_EQ(find(1.05), 1 - LensTrial::step);
}

TEST_F(LensTrialTest, KnowsNothingWhereThereIsNothingToSee) {
  frame.frame.color.own().fill({90, 90, 90});
  EXPECT_FALSE(find(0.95));
}

TEST_F(LensTrialTest, NeedsTheMarkerThatPosesComeFrom) {
  PoseRefinement refinement(frame.rig.color);
  SceneSamples samples;
  SceneSampler(frame.rig).sample(frame.frame, frame.poses, masks, samples);
  refinement.refine(frame.frame, masks.color, samples);
  ASSERT_TRUE(refinement.costs());
  EXPECT_FALSE(LensTrial(frame.rig, scene).find({}, frame.poses, refinement));
}

}  // namespace
}  // namespace diminish
