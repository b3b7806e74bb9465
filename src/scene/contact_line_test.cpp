#include "scene/contact_line.h"

#include <gtest/gtest.h>

#include <random>

#include "analytic_scene.h"
#include "detect/silhouette/disc_dilation.h"

namespace diminish {
namespace {

/// A box that stands on the scene's plane, which is a table here: z is up. Light on the table is
/// `darkest` beside the box and grows to 1 at `reach_m`.
class BoxOnATable : public ::testing::TestWithParam<LensModel> {
 protected:
  BoxOnATable() {
    scene.box_min = {-0.15, -0.1, 0};
    scene.box_max = {0.15, 0.1, 0.2};
    rig.color.fx *= 1.4;
    rig.color.fy *= 1.4;
  }

  double light(const Eigen::Vector3d& point) const {
    const Eigen::Vector2d nearest =
        point.head<2>().cwiseMax(scene.box_min.head<2>()).cwiseMin(scene.box_max.head<2>());
    if (point.x() > dark_up_to_x) return 1;
    const double share = 2 * (point.head<2>() - nearest).norm() / reach_m - 1;
    return darkest + (1 - darkest) * std::clamp(share, 0., 1.);
  }

  void find() {
    const Lens lens(rig.color);
    camera.resize(rig.color.width, rig.color.height);
    mask.resize(rig.color.width, rig.color.height, 0);
    lit.resize(rig.color.width, rig.color.height);
    std::mt19937 random(2);
    std::normal_distribution<double> noise(0, 6);
    scene.render(lens, color_from_world, [&](int x, int y, const AnalyticScene::Hit& hit) {
      mask(x, y) = hit.on_box ? 255 : 0;
      lit(x, y) = hit.on_box ? 1.F : static_cast<float>(light(hit.point));
      // With a slow grain.
      const double level =
          hit.on_box ? 40 : 150 * lit(x, y) * (1 + 0.06 * std::sin(90 * hit.point.y()));
      const auto noisy = static_cast<std::uint8_t>(std::clamp(level + noise(random), 0., 255.));
      camera(x, y) = {noisy, noisy, noisy};
    });
    DiscDilation().dilate(mask, margin_px);
    std::vector<std::vector<Eigen::Vector3d>> objects(1);
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d corner((i & 1) != 0 ? scene.box_max.x() : scene.box_min.x(),
                                   (i & 2) != 0 ? scene.box_max.y() : scene.box_min.y(),
                                   (i & 4) != 0 ? scene.box_max.z() : scene.box_min.z());
      objects[0].push_back(color_from_world * corner);
    }
    const Eigen::Vector3d normal = color_from_world.rotation * Eigen::Vector3d::UnitZ();
    const std::vector<BackgroundPlane> planes{
        {normal.cast<float>(), static_cast<float>(normal.dot(color_from_world.translation))}};
    ContactLine line(rig.color);
    line.find({camera, mask, objects, planes, margin_px, reach_px});
    found = Mask(mask.width(), mask.height());
    for (const Eigen::Vector2i& pixel : line.pixels()) found(pixel.x(), pixel.y()) = 255;
  }
  int count_found() const { return static_cast<int>(std::count(found.begin(), found.end(), 255)); }

  using AnalyticScene = testing::AnalyticScene;
  static constexpr int margin_px = 5, reach_px = 7;
  AnalyticScene scene;
  double darkest = 0.2, reach_m = 0.028, dark_up_to_x = 1;
  Rig rig = testing::small_rig(1, GetParam());
  RigidTransform color_from_world = testing::look_at({0.1, -0.7, 0.8}, {0, 0, 0.05});
  Image<Bgr> camera;
  Image<float> lit;
  Mask mask, found;
};
INSTANTIATE_TEST_SUITE_P(Lenses, BoxOnATable, ::testing::ValuesIn(testing::lens_models));

TEST_P(BoxOnATable, ItsDarkLineIsFound) {
  find();
  int dark = 0;
  int dark_found = 0;
  int wrong = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (found(x, y) != 0) {
        ASSERT_EQ(mask(x, y), 0);
        // Of the table around, where light is back, two pixels' width at most.
        wrong += lit(x, y) == 1 && lit(x, y - 3) == 1 && lit(std::max(x - 3, 0), y) == 1 &&
                         lit(std::min(x + 3, mask.width() - 1), y) == 1
                     ? 1
                     : 0;
      }
      if (mask(x, y) != 0 || lit(x, y) > 0.85F) continue;
      ++dark;
      dark_found += found(x, y) != 0 ? 1 : 0;
    }
  }
  EXPECT_GT(dark, 150);
  EXPECT_GE(dark_found * 20, dark * 19) << dark_found << " of " << dark;
  EXPECT_LT(wrong * 20, count_found()) << wrong << " of " << count_found();
}

TEST_P(BoxOnATable, WithoutALineThereIsNone) {
  darkest = 1;
  find();
  EXPECT_EQ(count_found(), 0);
}

TEST_P(BoxOnATable, AWideShadowIsNone) {
  reach_m = 0.2;
  find();
  EXPECT_EQ(count_found(), 0);
}

TEST_P(BoxOnATable, WhatIsOutOfSightHasNone) {
  color_from_world = testing::look_at({0.1, -0.7, 0.8}, {3, 0.5, 0.5});
  find();
  EXPECT_EQ(count_found(), 0);
  // Right before the camera: the foot is larger than the picture.
  scene.box_max = {0.15, 5, 0.1};
  scene.box_min = {-5, -0.68, 0};
  color_from_world = testing::look_at({0.1, -0.7, 0.04}, {0, 0, 0.04});
  find();
  EXPECT_EQ(count_found(), 0);
}

TEST_P(BoxOnATable, AShortLineIsNone) {
  dark_up_to_x = -0.14;
  find();
  EXPECT_EQ(count_found(), 0);
}

TEST_P(BoxOnATable, WhatDoesNotTouchThePlaneHasNone) {
  scene.box_min.z() += 0.08;
  scene.box_max.z() += 0.08;
  // Just as dark a line around it as if it stood there.
  reach_m = 0.06;
  find();
  EXPECT_EQ(count_found(), 0);
}

}  // namespace
}  // namespace diminish
