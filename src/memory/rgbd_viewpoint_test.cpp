#include "memory/rgbd_viewpoint.h"

#include <gtest/gtest.h>

#include "analytic_scene.h"
#include "scene/scene_sampler.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

/// An RGB-D camera beside the user's, by the lenses' model.
class Viewpoint : public ::testing::TestWithParam<LensModel> {
 protected:
  KeyframeView look() {
    SceneSampler(rig).sample(now.frame, now.poses, masks, samples);
    EXPECT_TRUE(viewpoint.go(inputs));
    return viewpoint.look(inputs, samples);
  }
  static void expect_same(const RigidTransform& a, const RigidTransform& b) {
    EXPECT_LT((a.translation - b.translation).norm(), 1e-9);
    EXPECT_LT((a.rotation - b.rotation).norm(), 1e-9);
  }
  static int difference(const Bgr& a, const Bgr& b) {
    return std::max({std::abs(a.b - b.b), std::abs(a.g - b.g), std::abs(a.r - b.r)});
  }

  const AnalyticScene scene{};
  AnalyticFrame now{scene, {Eigen::Vector3d(-0.25, 0.05, 1.1)}, GetParam(), {0.05, 0.02, 1.2}};
  const Rig& rig = now.rig;
  OcclusionMasks masks = testing::empty_masks(rig);
  const TiledRegion region{rig.color.bounds()};
  const Options options{};
  const bool in_doubt = false;
  const Rect no_objects{};
  const RecallInputs inputs{now.frame, now.poses, masks, no_objects, region, options, in_doubt};
  SceneSamples samples;
  RgbdViewpoint viewpoint{rig, 0};
};

TEST_P(Viewpoint, ShowsWhatTheUsersCameraWouldSeeThere) {
  const KeyframeView view = look();
  const RigidTransform there = rig.rgbd[0].color_from_depth * *now.poses.depth_from_world[0];
  const Image<Bgr> truth = scene.color_image(Lens(rig.color), there);
  int shown = 0;
  int wrong = 0;
  for (int y = 0; y < truth.height(); ++y) {
    for (int x = 0; x < truth.width(); ++x) {
      if (view.objects(x, y) != 0) continue;
      ++shown;
      constexpr int most = 8;  // levels: between its pixels, and at the box's edges
      wrong += difference(view.picture(x, y), truth(x, y)) > most ? 1 : 0;
    }
  }
  EXPECT_GT(shown, static_cast<int>(truth.size()) / 2);
  EXPECT_LT(wrong, shown / 50);
}

TEST_P(Viewpoint, HasItsPosesAndSamples) {
  const KeyframeView view = look();
  const RigidTransform there = rig.rgbd[0].color_from_depth * *now.poses.depth_from_world[0];
  expect_same(*view.poses.color_from_world, there);
  expect_same(*view.poses.color_from_depth[0], rig.rgbd[0].color_from_depth);
  ASSERT_GT(view.samples.surfaces.size(), samples.surfaces.size() / 2);
  const RigidTransform world_from_here = there.inverse();
  for (const SceneSample& sample : view.samples.surfaces) {
    const Eigen::Vector3d point = world_from_here * sample.point_m.cast<double>();
    const bool on_wall = std::abs(point.z()) < 0.01;
    const bool in_box = (point.array() > scene.box_min.array() - 0.01).all() &&
                        (point.array() < scene.box_max.array() + 0.01).all();
    EXPECT_TRUE(on_wall || in_box) << point.transpose();
  }
}

TEST_P(Viewpoint, HidesObjectsToRemove) {
  const Rect object{180, 90, 80, 60};
  const Bgr mark{0, 255, 255};
  masks.rgbd_color[0].fill(object, 255);
  now.frame.rgbd[0].color.own().fill(object, mark);
  const KeyframeView view = look();
  int hidden = 0;
  for (int y = 0; y < view.objects.height(); ++y) {
    for (int x = 0; x < view.objects.width(); ++x) {
      constexpr int alike = 60;
      if (difference(view.picture(x, y), mark) > alike) continue;
      EXPECT_NE(view.objects(x, y), 0) << x << ", " << y;
      ++hidden;
    }
  }
  EXPECT_GT(hidden, object.width * object.height / 3) << "it is in view";
}

TEST_P(Viewpoint, IsNowhereWithoutImagesOrPose) {
  now.poses.color_from_depth[0].reset();
  EXPECT_FALSE(viewpoint.go(inputs));
  now.poses.color_from_depth[0] = RigidTransform();
  now.frame.rgbd[0].missing = "rgbd0: lost";
  EXPECT_FALSE(viewpoint.go(inputs));
}

INSTANTIATE_TEST_SUITE_P(Lenses, Viewpoint, ::testing::ValuesIn(testing::lens_models));

}  // namespace
}  // namespace diminish
