#include "memory/measured_depth.h"

#include <gtest/gtest.h>

#include "analytic_scene.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

/// What the grid's places show, ray by ray.
Image<float> true_depth(const AnalyticScene& scene, const KeyframeGrid& grid,
                        const RigidTransform& color_from_world) {
  const Intrinsics& places = grid.intrinsics();
  Image<float> depth_m(places.width, places.height);
  scene.render(Lens(places), color_from_world, [&](int x, int y, const AnalyticScene::Hit& hit) {
    depth_m(x, y) = static_cast<float>((color_from_world * hit.point).z());
  });
  return depth_m;
}

struct Shares {
  double right = 0, wrong = 0;  ///< of all places; the others are not known
};
Shares compare(const Image<float>& depth_m, const Image<float>& expected_m) {
  constexpr float tolerance_m = 0.02F;
  int right = 0;
  int wrong = 0;
  for (int y = 0; y < depth_m.height(); ++y) {
    for (int x = 0; x < depth_m.width(); ++x) {
      if (depth_m(x, y) == 0) continue;
      const bool is_right = std::abs(depth_m(x, y) - expected_m(x, y)) < tolerance_m;
      (is_right ? right : wrong) += 1;
    }
  }
  const auto all = static_cast<double>(depth_m.size());
  return {right / all, wrong / all};
}

/// Measured from 1.5 m away; by how far away the user is.
class Measured : public ::testing::TestWithParam<double> {};

TEST_P(Measured, IsWhatTheUserWouldSee) {
  const AnalyticScene scene;
  const AnalyticFrame frame(scene, {Eigen::Vector3d(-0.1, 0.05, 1.5)}, LensModel::plumb_bob,
                            {0.05, 0.02, GetParam()});
  const KeyframeGrid grid(frame.rig.color);
  Image<float> depth_m;
  MeasuredDepth(frame.rig, grid)
      .draw(frame.frame, frame.poses, testing::empty_masks(frame.rig), {}, depth_m);
  const Shares shares = compare(depth_m, true_depth(scene, grid, *frame.poses.color_from_world));
  EXPECT_GT(shares.right, 0.8);
  EXPECT_LT(shares.wrong, 0.03) << "edges, and nothing through a surface";
}

INSTANTIATE_TEST_SUITE_P(FromTheWall, Measured, ::testing::Values(1.3, 1.0, 0.75));

TEST(MeasuredDepth, LeavesOutObjectsToRemove) {
  const AnalyticFrame frame({}, {Eigen::Vector3d(-0.1, 0.05, 1.5)});
  OcclusionMasks masks = testing::empty_masks(frame.rig);
  masks.rgbd_depth[0].fill(255);
  const KeyframeGrid grid(frame.rig.color);
  Image<float> depth_m;
  MeasuredDepth(frame.rig, grid).draw(frame.frame, frame.poses, masks, {}, depth_m);
  EXPECT_EQ(std::count(depth_m.begin(), depth_m.end(), 0.F),
            static_cast<std::ptrdiff_t>(depth_m.size()));
}

}  // namespace
}  // namespace diminish
