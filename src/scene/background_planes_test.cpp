#include "scene/background_planes.h"

#include <gtest/gtest.h>

#include "analytic_scene.h"
#include "scene/scene_sampler.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

const Eigen::Vector3d eye(-0.45, 0.3, 0.9);

class OnAnalyticScene : public ::testing::Test {
 protected:
  OnAnalyticScene() : frame(scene, {eye}) {
    SceneSampler(frame.rig).sample(frame.frame, frame.poses, testing::empty_masks(frame.rig), thin);
  }
  AnalyticScene scene;
  AnalyticFrame frame;
  SceneSamples thin;
  Reconstruction reconstruction;
  Surfaces surfaces;
  const std::vector<SceneSample>& samples = thin.surfaces;
};

// Points, pixels and colours against the ray caster.
TEST_F(OnAnalyticScene, SamplesLieOnSurfacesWhereTheCamerasSeeThem) {
  ASSERT_GT(samples.size(), 1500U);
  const RigidTransform& color_from_world = *frame.poses.color_from_world;
  const Lens lens(frame.rig.color);
  const Eigen::Vector3d depth_eye = frame.poses.depth_from_world[0]->inverse().translation;
  const Lens rgbd_lens(frame.rig.rgbd[0].color);
  const RigidTransform rgbd_from_world =
      frame.rig.rgbd[0].color_from_depth * *frame.poses.depth_from_world[0];
  for (const SceneSample& sample : samples) {
    const Eigen::Vector3d point = color_from_world.inverse() * sample.point_m.cast<double>();
    const auto hit = scene.cast(depth_eye, point - depth_eye);
    ASSERT_LT((hit.point - point).norm(), 5e-4);
    const auto pixel = lens.project(color_from_world * point);
    ASSERT_TRUE(pixel);
    EXPECT_LT((*pixel - sample.pixel.cast<double>()).norm(), 0.02);
    const auto texture = rgbd_lens.project(rgbd_from_world * point);
    ASSERT_TRUE(texture);
    EXPECT_LT((*texture - sample.texture.cast<double>()).norm(), 0.02);
    EXPECT_EQ(sample.source, 1);
  }
}

TEST_F(OnAnalyticScene, FindsTheWallAndLabelsWhatLiesOnIt) {
  BackgroundPlanes planes(frame.rig.color);
  planes.find(frame.rig.color.bounds(), samples);
  ASSERT_EQ(planes.planes().size(), 1U) << "the box bounds nothing";
  // In the world the wall is z = 0, seen from z > 0.
  const RigidTransform& color_from_world = *frame.poses.color_from_world;
  const Eigen::Vector3d normal = color_from_world.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_LT((planes.planes()[0].normal.cast<double>() - normal).norm(), 0.003);
  EXPECT_NEAR(
      planes.planes()[0].height_m((color_from_world * Eigen::Vector3d(0.1, 0.2, 0)).cast<float>()),
      0, 0.002);

  reconstruction.region = frame.rig.color.bounds();
  reconstruction.source.resize(320, 256, 1);
  reconstruction.depth_m.resize(320, 256);
  Image<std::uint8_t> expected(320, 256);
  scene.render(
      Lens(frame.rig.color), color_from_world, [&](int x, int y, const AnalyticScene::Hit& hit) {
        const bool measured = (x / 16 + y / 16) % 2 == 0;
        expected(x, y) =
            measured && hit.on_box ? surface_label::foreground : surface_label::first_plane;
        reconstruction.depth_m(x, y) =
            measured ? static_cast<float>((color_from_world * hit.point).z()) : 0.F;
      });
  planes.label(reconstruction, surfaces);
  int wrong = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    wrong += surfaces.label.data()[i] != expected.data()[i] ? 1 : 0;
  }
  EXPECT_LT(wrong, 320 * 256 / 500);
}

TEST_F(OnAnalyticScene, WithoutSamplesThereAreNoPlanes) {
  BackgroundPlanes planes(frame.rig.color);
  planes.find(frame.rig.color.bounds(), {});
  EXPECT_TRUE(planes.planes().empty());
  reconstruction.region = Rect{0, 0, 40, 30};
  reconstruction.source.resize(320, 256, 0);
  reconstruction.depth_m.resize(320, 256, 0.F);
  planes.label(reconstruction, surfaces);
  EXPECT_EQ(surfaces.label(10, 10), surface_label::unknown);
}

}  // namespace
}  // namespace diminish
