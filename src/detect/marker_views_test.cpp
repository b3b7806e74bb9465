#include "detect/marker_views.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "pose/marker_pose.h"

namespace diminish {
namespace {

std::vector<std::optional<RigidTransform>> located(const std::vector<MarkerView>& views,
                                                   double size_m) {
  std::vector<std::optional<RigidTransform>> camera_from_marker;
  locate_marker(views, size_m, camera_from_marker);
  return camera_from_marker;
}

using Corners = std::array<Eigen::Vector2d, 4>;

constexpr double size_m = 0.1;
const Lens lens(Intrinsics{
    1280, 1024, 1131.4, 1130.7, 645.2, 507.8, {-0.11, 0.09, 0.0006, -0.0004, 0}});

/// A marker that faces the camera, turned by `tilt` degrees about its vertical axis and a little
/// in its plane.
RigidTransform facing(double tilt_deg, const Eigen::Vector3d& position) {
  const Eigen::AngleAxisd turned(tilt_deg * M_PI / 180, Eigen::Vector3d::UnitY());
  const Eigen::AngleAxisd flipped(M_PI, Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd rolled(0.2, Eigen::Vector3d::UnitZ());
  return {(flipped * turned * rolled).toRotationMatrix(), position};
}

Corners see(const RigidTransform& camera_from_marker) {
  constexpr double half = size_m / 2;
  return {*lens.project(camera_from_marker * Eigen::Vector3d(-half, half, 0)),
          *lens.project(camera_from_marker * Eigen::Vector3d(half, half, 0)),
          *lens.project(camera_from_marker * Eigen::Vector3d(half, -half, 0)),
          *lens.project(camera_from_marker * Eigen::Vector3d(-half, -half, 0))};
}

void expect_near(const RigidTransform& pose, const RigidTransform& expected, double tolerance_m) {
  EXPECT_LT((pose.translation - expected.translation).norm(), tolerance_m);
  EXPECT_LT(rotation_difference_deg(pose.rotation, expected.rotation), 1);
}

const RigidTransform second_from_first{
    Eigen::AngleAxisd(0.9, Eigen::Vector3d::UnitY()).toRotationMatrix(), {-1.3, 0.1, 0.5}};

TEST(MarkerViews, ACameraThatDoesNotSeeTheMarkerGetsThePoseFromTheOneThatSeesItLargest) {
  const RigidTransform first_from_marker = facing(35, {0.1, 0, 1.5});
  Corners spoilt = see(facing(10, {0.3, 0.2, 5}));
  const std::vector<MarkerView> views = {{&lens, spoilt, RigidTransform{}},
                                         {&lens, see(first_from_marker), RigidTransform{}},
                                         {&lens, {}, second_from_first.inverse()}};
  const auto poses = located(views, size_m);
  ASSERT_TRUE(poses[2]);
  expect_near(*poses[2], second_from_first * first_from_marker, 0.002);
}

TEST(MarkerViews, WithoutAKnownWayThereIsNoPose) {
  const RigidTransform first_from_marker = facing(35, {0.1, 0, 1.5});
  const auto poses = located({{&lens, see(first_from_marker), RigidTransform{}},
                              {&lens, {}, {}},
                              {&lens, see(first_from_marker), {}}},
                             size_m);
  ASSERT_TRUE(poses[0]);
  EXPECT_FALSE(poses[1]);
  ASSERT_TRUE(poses[2]);
  expect_near(*poses[2], first_from_marker, 0.002);
}

TEST(MarkerViews, AnAmbiguousPoseIsDecidedByTheOtherCamera) {
  const RigidTransform first_from_marker = facing(20, {0.1, 0.05, 2.5});
  const RigidTransform second_from_marker = second_from_first * first_from_marker;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.3);
  int wrong_alone = 0;
  for (int repeat = 0; repeat < 100; ++repeat) {
    Corners in_first = see(first_from_marker);
    for (Eigen::Vector2d& corner : in_first)
      corner += Eigen::Vector2d(noise(random), noise(random));
    const auto alone = estimate_marker_pose(in_first, size_m, lens);
    ASSERT_TRUE(alone);
    const auto error_deg = [&](const RigidTransform& pose) {
      return rotation_difference_deg(pose.rotation, first_from_marker.rotation);
    };
    if (alone->ambiguity < 0.4) continue;
    if (error_deg(alone->camera_from_marker) < error_deg(alone->alternative)) continue;
    ++wrong_alone;
    const auto poses = located({{&lens, in_first, RigidTransform{}},
                                {&lens, see(second_from_marker), second_from_first.inverse()}},
                               size_m);
    ASSERT_TRUE(poses[0]);
    EXPECT_LT(error_deg(*poses[0]), error_deg(alone->camera_from_marker));
  }
  EXPECT_GT(wrong_alone, 0);
}

}  // namespace
}  // namespace diminish
