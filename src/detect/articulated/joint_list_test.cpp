#include "detect/articulated/joint_list.h"

#include <sstream>

#include "expect_error.h"

namespace diminish {
namespace {

JointList read_joints(const std::string& text, std::size_t joints = 2) {
  std::istringstream stream(text);
  return JointList::read(stream, "angles.txt", joints);
}

TEST(JointList, PositionsChangeEvenlyBetweenTheLinesOfTheList) {
  const JointList list = read_joints("# time, two joints\n1 0 10\n2 1 20\n\n4 3 0\n");
  std::vector<double> positions;
  ASSERT_TRUE(list.at(1.25, 1, positions));
  EXPECT_EQ(positions, (std::vector<double>{0.25, 12.5}));
  ASSERT_TRUE(list.at(4, 1, positions));
  EXPECT_EQ(positions, (std::vector<double>{3, 0}));
  // Before and after, as at the ends
  ASSERT_TRUE(list.at(0.5, 1, positions));
  EXPECT_EQ(positions, (std::vector<double>{0, 10}));
  ASSERT_TRUE(list.at(4.5, 1, positions));
  EXPECT_EQ(positions, (std::vector<double>{3, 0}));
}

TEST(JointList, SaysNothingFarFromItsMoments) {
  const JointList list = read_joints("1 0 0\n2 1 1\n");
  std::vector<double> positions;
  EXPECT_FALSE(list.at(2.2, 0.1, positions));
  EXPECT_FALSE(list.at(1.5, 0.1, positions));
  EXPECT_TRUE(list.at(1.95, 0.1, positions));
}

TEST(JointList, WhatIsWrongIsNamedWithItsLine) {
  EXPECT_EQ(error_of([] { read_joints("1 0 0\n2 1\n"); }),
            "angles.txt:2: expected a timestamp and the positions of 2 joints, got 2 numbers");
  EXPECT_EQ(error_of([] { read_joints("1 0 0\n1 0 0\n"); }),
            "angles.txt:2: expected ascending timestamps");
  EXPECT_EQ(error_of([] { read_joints("1 0 nan\n"); }), "angles.txt:1: expected a finite number");
  EXPECT_EQ(error_of([] { read_joints("# nothing\n"); }),
            "angles.txt: expected at least one line of joint positions");
}

}  // namespace
}  // namespace diminish
