#include "detect/segment/depth_outline.h"

#include <gtest/gtest.h>

#include "analytic_scene.h"
#include "mask_overlap.h"

namespace diminish {
namespace {

/// A square 1 m in front of the camera, whose wall is 2 m away.
class DepthOutlineTest : public ::testing::Test {
 protected:
  DepthOutlineTest() {
    camera.color_from_depth = {};
    camera.color = camera.depth;
    depth.resize(camera.depth.width, camera.depth.height, value(2));
    depth.fill(object, value(1));
    truth.resize(camera.color.width, camera.color.height, 0);
    truth.fill(object, 255);
  }
  std::uint16_t value(double depth_m) const {
    return static_cast<std::uint16_t>(depth_m / camera.depth_unit_m);
  }
  Mask refined(const Rect& found) {
    Mask mask(camera.color.width, camera.color.height);
    mask.fill(found, 255);
    DepthOutline(camera).refine(depth, 6, 0.05F, mask);
    return mask;
  }

  static constexpr Rect object{60, 50, 50, 40};
  static constexpr Rect shifted{64, 46, 50, 40};
  static constexpr Rect small{63, 54, 43, 33};
  static constexpr Rect large{57, 46, 57, 47};
  RgbdCamera camera = testing::small_rig().rgbd[0];
  Image<std::uint16_t> depth;
  Mask truth;
};

TEST_F(DepthOutlineTest, FollowsTheStepInDepth) {
  for (const Rect& found : {shifted, small, large}) {
    Mask before(camera.color.width, camera.color.height);
    before.fill(found, 255);
    EXPECT_LT(intersection_over_union(before, truth), 0.8);
    EXPECT_GT(intersection_over_union(refined(found), truth), 0.93);
  }
}

TEST_F(DepthOutlineTest, WithoutAStepTheNetworkIsBelieved) {
  depth.fill(value(2));
  Mask expected(camera.color.width, camera.color.height);
  expected.fill(large, 255);
  EXPECT_EQ(refined(large), expected);
  depth.fill(0);
  EXPECT_EQ(refined(large), expected);
}

}  // namespace
}  // namespace diminish
