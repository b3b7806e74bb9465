#include "detect/articulated/kinematic_chain.h"

#include <cmath>

#include "expect_error.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

KinematicChain read_chain(const std::string& links) {
  return KinematicChain::read(Config::parse("links:\n" + links, "arm.yaml"));
}

const std::string base = "  - {name: base, mesh: base.obj}\n";

TEST(KinematicChain, MovesLinksAsTheirJointsTurn) {
  // Two bars of 1 m, the second at the end of the first, and a slide along the second.
  const KinematicChain chain = read_chain(
      base +
      "  - {name: first, mesh: bar.obj, parent: base, origin: [0, 0, 0.5], axis: [0, 0, 2]}\n"
      "  - {name: second, mesh: bar.obj, parent: first, origin: [1, 0, 0], axis: [0, 0, 1]}\n"
      "  - {name: slide, mesh: bar.obj, parent: second, axis: [1, 0, 0], joint: prismatic}\n");
  EXPECT_EQ(chain.joint_count(), 3U);
  std::vector<RigidTransform> base_from_link;
  const double quarter = std::acos(0.0);
  chain.move({quarter, -quarter, 0.25}, base_from_link);
  ASSERT_EQ(base_from_link.size(), 4U);
  EXPECT_TRUE(base_from_link[0].translation.isZero());
  EXPECT_TRUE((base_from_link[1] * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0, 1, 0.5)));
  EXPECT_TRUE((base_from_link[2] * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 1, 0.5)));
  EXPECT_TRUE(
      (base_from_link[3] * Eigen::Vector3d(0, 0, 0)).isApprox(Eigen::Vector3d(0.25, 1, 0.5)));
}

TEST(KinematicChain, JointsMayBeTurnedInTheirParent) {
  const KinematicChain chain = read_chain(
      base +
      "  - {name: up, mesh: bar.obj, parent: base, rotation: [1, 0, 0, 0, 0, -1, 0, 1, 0], axis: "
      "[0, 0, 1]}\n");
  std::vector<RigidTransform> base_from_link;
  chain.move({std::acos(0.0)}, base_from_link);
  // It turns about the parent's -y.
  EXPECT_TRUE((base_from_link[1] * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0, 0, 1)));
}

TEST(KinematicChain, WhatIsWrongIsNamed) {
  const auto complaint = [](const std::string& links) {
    return error_of([&] { read_chain(links); });
  };
  EXPECT_THAT(complaint(base + "  - {name: a, mesh: a.obj, parent: none}\n"),
              HasSubstr("links[1].parent: expected one of the earlier links base, got 'none'"));
  EXPECT_THAT(complaint("  - {name: a, mesh: a.obj, parent: a}\n"),
              HasSubstr("links[0].parent: expected an earlier link"));
  EXPECT_THAT(complaint(base + base), HasSubstr("there are two links called 'base'"));
  EXPECT_THAT(complaint(base + "  - {name: a, mesh: a.obj, axis: [0, 0, 0]}\n"),
              HasSubstr("links[1].axis: expected a direction"));
  EXPECT_THAT(complaint(base + "  - {name: a, mesh: a.obj, joint: hinge}\n"),
              HasSubstr("links[1].joint: expected revolute, prismatic or fixed, got 'hinge'"));
  EXPECT_THAT(complaint(base + "  - {name: a, mesh: a.obj, joint: revolute}\n"),
              HasSubstr("links[1]: missing key 'axis'"));
  EXPECT_THAT(
      complaint(base + "  - {name: a, mesh: a.obj, rotation: [1, 0, 0, 0, 1, 0, 0, 0, 2]}\n"),
      HasSubstr("rotation"));
}

}  // namespace
}  // namespace diminish
