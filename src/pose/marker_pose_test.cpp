#include "pose/marker_pose.h"

#include <gtest/gtest.h>

#include <random>

namespace diminish {
namespace {

const Intrinsics color{1280, 1024, 1131.4, 1130.7, 645.2, 507.8, {-0.11, 0.09, 0.0006, -0.0004, 0}};

const Intrinsics wide{1280,
                      1024,
                      700,
                      700,
                      645.2,
                      507.8,
                      {0.3, 0.1, 0.0006, -0.0004, 0.02, 0.55, 0.12, 0.03},
                      LensModel::rational};
const Intrinsics fisheye{
    1280, 1024, 600, 600, 645.2, 507.8, {0.02, -0.01, 0.003, -0.001}, LensModel::fisheye};

/// A marker that faces the camera (its z towards it), then turned.
RigidTransform facing(double tilt_rad, const Eigen::Vector3d& axis, const Eigen::Vector3d& at) {
  const Eigen::Matrix3d flip =
      Eigen::AngleAxisd(3.14159265358979, Eigen::Vector3d::UnitX()).matrix();
  return {Eigen::AngleAxisd(tilt_rad, axis.normalized()).matrix() * flip, at};
}

std::array<Eigen::Vector2d, 4> project_corners(const RigidTransform& camera_from_marker,
                                               double size_m, const Lens& lens) {
  std::array<Eigen::Vector2d, 4> pixels;
  const auto points = marker_corners(size_m);
  for (std::size_t i = 0; i < 4; ++i) pixels[i] = *lens.project(camera_from_marker * points[i]);
  return pixels;
}

TEST(EstimateMarkerPose, IsExactOnExactCorners) {
  for (const Intrinsics& intrinsics : {color, wide, fisheye}) {
    const Lens lens(intrinsics);
    for (const double tilt : {0.0, 1e-6, 1e-3, 0.3, 0.8, 1.2}) {
      const RigidTransform truth = facing(tilt, {0.3, 1, 0.2}, {-0.2, 0.1, 1.5});
      const auto pose = estimate_marker_pose(project_corners(truth, 0.2, lens), 0.2, lens);
      ASSERT_TRUE(pose);
      EXPECT_LT((pose->camera_from_marker.translation - truth.translation).norm(), 1e-5);
      EXPECT_LT(rotation_difference_deg(pose->camera_from_marker.rotation, truth.rotation), 1e-3);
      EXPECT_LT(pose->error_px, 1e-4);
      EXPECT_LT(pose->ambiguity, 0.05);
    }
  }
}

// Far away and nearly weak perspective: the truth must be one of the two, and it must be said that
// they are hard to tell apart.
TEST(EstimateMarkerPose, GivesBothSolutionsWhereTwoFit) {
  const Lens lens(color);
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.25);
  int wrong_choices = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const RigidTransform truth = facing(0.5, {std::cos(trial), std::sin(trial), 0}, {0.1, 0.1, 6});
    auto corners = project_corners(truth, 0.2, lens);
    for (auto& corner : corners) corner += Eigen::Vector2d(noise(random), noise(random));
    const auto pose = estimate_marker_pose(corners, 0.2, lens);
    ASSERT_TRUE(pose);
    const double best = rotation_difference_deg(pose->camera_from_marker.rotation, truth.rotation);
    const double other = rotation_difference_deg(pose->alternative.rotation, truth.rotation);
    EXPECT_LT(std::min(best, other), 20) << "trial " << trial;
    if (other < best) {
      ++wrong_choices;
      EXPECT_GT(pose->ambiguity, 0.2) << "a wrong choice must be known to be doubtful";
    }
  }
  EXPECT_GT(wrong_choices, 0) << "the test is too easy to show anything";
}

TEST(EstimateMarkerPose, RefusesCornersThatAreNoMarker) {
  const Lens lens(color);
  const std::array<Eigen::Vector2d, 4> counterclockwise = {
      Eigen::Vector2d(100, 100), {100, 200}, {200, 200}, {200, 100}};
  EXPECT_FALSE(estimate_marker_pose(counterclockwise, 0.2, lens));
  const std::array<Eigen::Vector2d, 4> line = {
      Eigen::Vector2d(100, 100), {150, 100}, {200, 100}, {250, 100}};
  EXPECT_FALSE(estimate_marker_pose(line, 0.2, lens));
}

}  // namespace
}  // namespace diminish
