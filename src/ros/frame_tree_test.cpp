#include "ros/frame_tree.h"

#include <gtest/gtest.h>

namespace diminish::ros {
namespace {

RigidTransform transform(double angle, double x, double y, double z) {
  return {Eigen::AngleAxisd(angle, Eigen::Vector3d(.3, -.5, .8).normalized()).toRotationMatrix(),
          {x, y, z}};
}

TransformStamped edge(const std::string& parent, const std::string& child,
                      const RigidTransform& parent_from_child) {
  return {{.stamp_s = 0, .frame_id = parent}, child, parent_from_child};
}

TEST(FrameTree, GoesUpAndDown) {
  const RigidTransform link_from_color = transform(.4, 1, 0, 0),
                       link_from_depth = transform(-1, 0, 2, 0),
                       map_from_link = transform(2, 0, 0, 3);
  FrameTree tree;
  tree.add({{edge("camera_link", "color", link_from_color),
             edge("/camera_link", "/depth", link_from_depth)}});
  tree.add({{edge("map", "camera_link", map_from_link)}});
  const auto color_from_depth = tree.find("color", "depth");
  ASSERT_TRUE(color_from_depth);
  const Eigen::Vector3d x_in_depth(.1, .2, .3);
  const Eigen::Vector3d x_in_link = link_from_depth * x_in_depth;
  EXPECT_TRUE((link_from_color * (*color_from_depth * x_in_depth)).isApprox(x_in_link, 1e-12));
  const auto map_from_depth = tree.find("map", "depth");
  ASSERT_TRUE(map_from_depth);
  EXPECT_TRUE((*map_from_depth * x_in_depth).isApprox(map_from_link * x_in_link, 1e-12));
  EXPECT_TRUE(tree.find("depth", "map"));
  EXPECT_TRUE(tree.find("color", "color"));
  EXPECT_FALSE(tree.find("color", "elsewhere"));
}

TEST(FrameTree, TheNewestTransformCounts) {
  FrameTree tree;
  tree.add({{edge("a", "b", transform(0, 1, 0, 0))}});
  tree.add({{edge("a", "b", transform(0, 2, 0, 0))}});
  EXPECT_EQ(tree.find("a", "b")->translation.x(), 2);
}

TEST(FrameTree, CirclesEnd) {
  FrameTree tree;
  tree.add({{edge("a", "b", {}), edge("b", "a", {}), edge("c", "c", {})}});
  EXPECT_TRUE(tree.find("a", "b"));
  EXPECT_FALSE(tree.find("a", "c"));
}

}  // namespace
}  // namespace diminish::ros
