#include "bars/shadow_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "analytic_scene.h"
#include "bare_depth.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

/// A box before a wall, and an RGB-D camera with its projector beside it.
class ProjectorShadow : public ::testing::Test {
 protected:
  ProjectorShadow() {
    scene.wave_m = 0.5;
    scene.box_min = {-0.15, -0.6, 0.2};
    scene.box_max = {0.15, 0.6, 0.4};
    seen.emplace(scene, std::vector<Eigen::Vector3d>{{-0.3, 0.05, 1.05}});
    masks = testing::empty_masks(seen->rig);
    testing::hide({200, 80, 100, 60}, masks);
    const RigidTransform world_from_depth = seen->poses.depth_from_world[0]->inverse();
    eye = world_from_depth.translation;
    projector = world_from_depth * Eigen::Vector3d(-0.12, 0, 0);
    seen->frame.rgbd[0].depth = testing::depth_image_without(
        scene, *seen, [&](const AnalyticScene::Hit& hit) { return is_in_shadow(hit); });
  }
  bool is_in_shadow(const AnalyticScene::Hit& hit) const {
    return !hit.on_box && scene.cast(projector, hit.point - projector).on_box;
  }
  /// Inverse depths, by pixel; 0: nothing.
  Image<float> find() {
    BarViews views(seen->rig);
    views.begin(seen->frame, seen->poses, masks);
    ShadowSurfaces shadows(seen->rig);
    const std::vector<ColorMap> maps(256);
    shadows.find({views, seen->frame, seen->poses, masks, samples(), maps});
    const Rect whole = seen->rig.color.bounds();
    Image<float> found(whole.width, whole.height);
    shadows.for_each_node(whole, 1, [&](int x, int y, float inverse_m, std::size_t k) {
      EXPECT_EQ(k, 0U);
      found(x, y) = std::max(found(x, y), inverse_m);
    });
    return found;
  }
  /// The box, which hides part of the shadow from the user.
  std::vector<SceneSample> samples() const {
    std::vector<SceneSample> found;
    visit_user([&](int x, int y, const AnalyticScene::Hit& hit) {
      if (!hit.on_box || x % 4 != 0 || y % 4 != 0) return;
      SceneSample& sample = found.emplace_back();
      sample.point_m = (*seen->poses.color_from_world * hit.point).cast<float>();
      sample.pixel = Eigen::Vector2f(x, y);
    });
    return found;
  }
  template <class Visit>
  void visit_user(const Visit& visit) const {
    scene.render(Lens(seen->rig.color), *seen->poses.color_from_world, visit);
  }

  AnalyticScene scene;
  std::optional<AnalyticFrame> seen;
  OcclusionMasks masks;
  Eigen::Vector3d eye, projector;  ///< of the RGB-D camera
};

// Against the ray caster.
TEST_F(ProjectorShadow, IsOnTheWall) {
  const Image<float> found = find();
  int in_shadow = 0;
  int closed = 0;
  int elsewhere = 0;
  double error_m = 0;
  visit_user([&](int x, int y, const AnalyticScene::Hit& hit) {
    // Nobody looks through the box.
    if (hit.on_box || scene.cast(eye, hit.point - eye).on_box) return;
    const bool is_shadow = is_in_shadow(hit);
    in_shadow += is_shadow ? 1 : 0;
    if (found(x, y) == 0) return;
    (is_shadow ? closed : elsewhere) += 1;
    error_m += std::abs(1 / found(x, y) - (*seen->poses.color_from_world * hit.point).z());
  });
  EXPECT_GT(in_shadow, 1000);
  EXPECT_GT(closed, in_shadow * 8 / 10);
  EXPECT_LT(elsewhere, in_shadow / 5);
  // The wall is slanted for the RGB-D camera, but a row's shadow is drawn at one depth.
  EXPECT_LT(error_m / (closed + elsewhere), 0.015);
}

// A gap of another kind: what the RGB-D camera sees there is elsewhere for the user.
TEST_F(ProjectorShadow, IsNotBelievedWhereTheUsersPictureContradicts) {
  Image<Bgr> color = seen->frame.rgbd[0].color.own();
  for (std::size_t i = 0; i < color.size(); ++i) color.data()[i].b ^= 64;
  seen->frame.rgbd[0].color = std::move(color);
  const Image<float> found = find();
  EXPECT_EQ(std::count(found.data(), found.data() + found.size(), 0.F),
            static_cast<std::ptrdiff_t>(found.size()));
}

}  // namespace
}  // namespace diminish
