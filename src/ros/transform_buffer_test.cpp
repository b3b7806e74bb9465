#include "ros/transform_buffer.h"

#include <gtest/gtest.h>

namespace diminish::ros {
namespace {

using Kind = TransformBuffer::Found::Kind;

RigidTransform turned(double angle, const Eigen::Vector3d& place) {
  const Eigen::Vector3d axis = Eigen::Vector3d(.2, -.4, .7).normalized();
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), place};
}
/// A robot that drives straight ahead and turns evenly.
RigidTransform robot_at(double time_s) {
  return turned(.3 * time_s, {1 + .5 * time_s, -.2 * time_s, 0});
}

TransformStamped stamped_edge(const std::string& parent, const std::string& child,
                              const RigidTransform& parent_from_child, double stamp_s = 0) {
  return {{stamp_s, parent}, child, parent_from_child};
}

void expect_same(const RigidTransform& a, const RigidTransform& b) {
  EXPECT_LT((a.translation - b.translation).norm(), 1e-9);
  EXPECT_LT((a.rotation - b.rotation).norm(), 1e-9);
}

class TransformBuffers : public ::testing::Test {
 protected:
  void drive(double from_s, double to_s, double step_s) {
    for (int i = 0; from_s + i * step_s < to_s + 1e-9; ++i) {
      const double t = from_s + i * step_s;
      buffer_.add({{stamped_edge("map", "base", robot_at(t), t)}}, 0);
    }
  }
  TransformBuffer buffer_;
};

TEST_F(TransformBuffers, AnEvenMotionIsInterpolatedExactly) {
  const RigidTransform base_from_camera = turned(1.2, {.1, .2, .3});
  buffer_.add_static({{stamped_edge("base", "camera", base_from_camera)}});
  drive(0, 2, .1);
  for (const double t : {0., .05, .1, .777, 1.9999, 2.}) {
    const auto found = buffer_.find("camera", "map", t, .2);
    ASSERT_EQ(found.kind, Kind::known) << t;
    expect_same(found.to_from_from, (robot_at(t) * base_from_camera).inverse());
    expect_same(buffer_.find("/map", "/camera", t, .2).to_from_from,
                robot_at(t) * base_from_camera);
  }
}

TEST_F(TransformBuffers, EachFrameIsInterpolatedByItsOwnMoments) {
  drive(0, 2, .1);
  // An arm that moves on the robot, told at other times.
  for (int i = 0; i < 31; ++i) {
    const double t = -.03 + .07 * i;
    buffer_.add({{stamped_edge("base", "camera", turned(-t, {0, t, 0}), t)}}, 0);
  }
  const auto found = buffer_.find("map", "camera", 1.234, .2);
  ASSERT_EQ(found.kind, Kind::known);
  expect_same(found.to_from_from, robot_at(1.234) * turned(-1.234, {0, 1.234, 0}));
}

TEST_F(TransformBuffers, WhatIsMissingIsSaid) {
  EXPECT_EQ(buffer_.find("camera", "map", 1, .2).kind, Kind::unknown);
  drive(5, 6, .1);
  drive(7, 8, .1);
  EXPECT_EQ(buffer_.find("camera", "map", 5.5, .2).kind, Kind::unknown);
  const auto later = buffer_.find("map", "base", 8.3, .2);
  EXPECT_EQ(later.kind, Kind::not_yet);
  EXPECT_EQ(later.frame, "base");
  EXPECT_NEAR(later.newest_s, 8, 1e-9);
  EXPECT_EQ(buffer_.find("map", "base", 4.9, .2).kind, Kind::lost);
  EXPECT_EQ(buffer_.find("map", "base", 6.5, .2).kind, Kind::lost);
  EXPECT_EQ(buffer_.find("map", "base", 6.5, 2).kind, Kind::known);
  EXPECT_EQ(buffer_.find("base", "base", 99, .2).kind, Kind::known);
}

TEST_F(TransformBuffers, StampsOfAnotherClockAreMoved) {
  buffer_.add({{stamped_edge("map", "base", robot_at(1), 1001)}}, -1000);
  buffer_.add({{stamped_edge("map", "base", robot_at(2), 1002)}}, -1000);
  expect_same(buffer_.find("map", "base", 1.5, 2).to_from_from, robot_at(1.5));
}

TEST_F(TransformBuffers, TheOrderOfArrivalDoesNotMatter) {
  for (const double t : {1., 3., 2., 0., 2.}) {
    buffer_.add({{stamped_edge("map", "base", robot_at(t), t)}}, 0);
  }
  for (const double t : {.5, 1.5, 2.5}) {
    expect_same(buffer_.find("map", "base", t, 1).to_from_from, robot_at(t));
  }
}

TEST_F(TransformBuffers, OldOnesGoAndAClockMayBeSetBack) {
  drive(0, 30, .1);
  EXPECT_EQ(buffer_.find("map", "base", 19, 1).kind, Kind::lost);
  EXPECT_EQ(buffer_.find("map", "base", 21, 1).kind, Kind::known);
  drive(0, .5, .1);
  EXPECT_EQ(buffer_.find("map", "base", .25, 1).kind, Kind::known);
  EXPECT_EQ(buffer_.find("map", "base", 21, 1).kind, Kind::not_yet);
  // More than there is room for: the newest stay.
  for (int i = 0; i < 2000; ++i) {
    buffer_.add({{stamped_edge("map", "base", robot_at(.5 + i * .001), .5 + i * .001)}}, 0);
  }
  EXPECT_EQ(buffer_.find("map", "base", .25, 1).kind, Kind::lost);
  expect_same(buffer_.find("map", "base", 2.2, 1).to_from_from, robot_at(2.2));
}

TEST_F(TransformBuffers, CirclesEndAndFramesAreLimited) {
  buffer_.add_static(
      {{stamped_edge("a", "b", {}), stamped_edge("b", "a", {}), stamped_edge("c", "c", {})}});
  EXPECT_EQ(buffer_.find("a", "b", 1, 1).kind, Kind::known);
  EXPECT_EQ(buffer_.find("a", "c", 1, 1).kind, Kind::unknown);
  for (int i = 0; i < 2000; ++i) {
    buffer_.add_static({{stamped_edge("a", std::to_string(i), {})}});
  }
  EXPECT_EQ(buffer_.frames(), 1000U);
}

TEST_F(TransformBuffers, AFrameThatGetsAnotherParentBeginsAnew) {
  drive(0, 2, .1);
  buffer_.add({{stamped_edge("lift", "base", {}, 2.1)}}, 0);
  EXPECT_EQ(buffer_.find("map", "base", 1, 1).kind, Kind::unknown);
  EXPECT_EQ(buffer_.find("lift", "base", 2.1, 1).kind, Kind::known);
}

}  // namespace
}  // namespace diminish::ros
