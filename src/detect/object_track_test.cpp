#include "detect/object_track.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace diminish {
namespace {

RigidTransform at(double x, double y) {
  RigidTransform pose;
  pose.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.translation = {x, y, 1};
  return pose;
}

TEST(ObjectTrack, GoesOnAsItMoved) {
  ObjectTrack track;
  // 0.5 m/s along x, and errors of 1 mm across.
  for (int i = 0; i < 20; ++i) track.add(100 + 0.03 * i, true, at(0.015 * i, i % 2 * 0.001));
  const double last_s = 100 + 0.03 * 19;
  const auto moved = track.at(last_s + 0.2, true);
  ASSERT_TRUE(moved);
  EXPECT_NEAR(moved->translation.x(), 0.015 * 19 + 0.1, 1e-9);
  EXPECT_NEAR(moved->translation.y(), 0.0005, 0.001);
  EXPECT_TRUE(moved->rotation.isApprox(at(0, 0).rotation));
}

TEST(ObjectTrack, FollowsItsLatestMotionOnly) {
  ObjectTrack track;
  for (int i = 0; i < 10; ++i) track.add(0.1 * i, true, at(0.1 * i, 0));
  for (int i = 10; i < 20; ++i) track.add(0.1 * i, true, at(0.9, 0));
  EXPECT_NEAR(track.at(2.2, true)->translation.x(), 0.9, 1e-9);
}

TEST(ObjectTrack, IsBelievedForAMoment) {
  ObjectTrack track;
  EXPECT_FALSE(track.at(0, true));
  track.add(10, true, at(0, 0));
  EXPECT_TRUE(track.at(10 + ObjectTrack::longest_s, true));
  EXPECT_FALSE(track.at(10.01 + ObjectTrack::longest_s, true));
}

TEST(ObjectTrack, BeginsAnewInAnotherFrameAndWhenTimeGoesBack) {
  ObjectTrack track;
  track.add(10, true, at(0, 0));
  EXPECT_FALSE(track.at(10.1, false));
  EXPECT_FALSE(track.at(9.9, true));
  track.add(5, true, at(1, 0));
  track.add(5.1, true, at(1, 0));
  EXPECT_NEAR(track.at(5.2, true)->translation.x(), 1, 1e-9);
  track.add(5.2, false, at(3, 0));
  EXPECT_NEAR(track.at(5.3, false)->translation.x(), 3, 1e-9);
}

}  // namespace
}  // namespace diminish
