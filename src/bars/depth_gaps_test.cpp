#include "bars/depth_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "analytic_scene.h"
#include "bare_depth.h"
#include "diminish/diminished_frame.h"
#include "picture_difference.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

/// A wall, of which an RGB-D camera measures no depth in part.
class Gaps : public ::testing::Test {
 protected:
  /// bare: whether no depth is measured where the RGB-D camera sees this.
  template <class Bare>
  void look(const Bare& bare) {
    scene.has_box = false;
    scene.wave_m = 0.5;
    seen.emplace(scene, std::vector<Eigen::Vector3d>{{-0.3, 0.05, 1.05}});
    masks = testing::empty_masks(seen->rig);
    testing::hide(hidden, masks);
    seen->frame.rgbd[0].depth = testing::depth_image_without(scene, *seen, bare);
    // What the RGB-D camera has depth of is drawn.
    const Rect whole = seen->rig.color.bounds();
    drawn.region.set(whole);
    drawn.color = Image<Bgra>(whole.width, whole.height);
    drawn.depth_m = Image<float>(whole.width, whole.height);
    drawn.source = Image<std::uint8_t>(whole.width, whole.height);
    truth_m = Image<float>(whole.width, whole.height);
    is_bare = Mask(whole.width, whole.height);
    scene.render(Lens(seen->rig.color), *seen->poses.color_from_world,
                 [&](int x, int y, const AnalyticScene::Hit& hit) {
                   const auto z_m =
                       static_cast<float>((*seen->poses.color_from_world * hit.point).z());
                   truth_m(x, y) = z_m;
                   is_bare(x, y) = bare(hit) ? 255 : 0;
                   drawn.depth_m(x, y) = bare(hit) ? 0 : z_m;
                   drawn.source(x, y) = bare(hit) ? 0 : 1;
                 });
    for (int y = hidden.y; y < hidden.bottom(); ++y) {
      for (int x = hidden.x; x < hidden.right(); ++x) {
        hidden_bare += is_bare(x, y) != 0 ? 1 : 0;
      }
    }
  }
  void draw() {
    BarViews views(seen->rig);
    views.begin(seen->frame, seen->poses, masks);
    DepthGaps gaps(seen->rig);
    const std::vector<ColorMap> maps(256);
    gaps.find_shadows({views, seen->frame, seen->poses, masks, {}, maps});
    gaps.draw({views, seen->frame, seen->poses, masks, {}, maps}, seen->rig.color.bounds(), drawn);
  }
  std::size_t count_drawn() const {
    return static_cast<std::size_t>(std::count(
        drawn.source.data(), drawn.source.data() + drawn.source.size(), provenance::estimated));
  }

  AnalyticScene scene;
  const Rect hidden{100, 80, 120, 90};  ///< by the object, in the user's picture
  std::optional<AnalyticFrame> seen;
  OcclusionMasks masks;
  Image<float> truth_m;
  Mask is_bare;
  std::size_t hidden_bare = 0;
  Reconstruction drawn;
};

bool is_in_band(const AnalyticScene::Hit& hit) {
  return std::abs(hit.point.y()) < 0.06;
}

// Against the ray caster.
TEST_F(Gaps, AreClosedAsTheUserWouldSeeThem) {
  look(is_in_band);
  draw();
  EXPECT_GT(count_drawn(), hidden_bare * 9 / 10);
  double error = 0;
  double depth_error_m = 0;
  for (int y = 0; y < drawn.source.height(); ++y) {
    for (int x = 0; x < drawn.source.width(); ++x) {
      if (drawn.source(x, y) != provenance::estimated) continue;
      ASSERT_TRUE(hidden.contains(x, y) && is_bare(x, y) != 0) << x << ", " << y;
      const Bgra& own = drawn.color(x, y);
      const Bgr& truth = seen->frame.color(x, y);
      error += std::abs(own.b - truth.b) + std::abs(own.g - truth.g) + std::abs(own.r - truth.r);
      depth_error_m += std::abs(drawn.depth_m(x, y) - truth_m(x, y));
    }
  }
  const auto pixels = static_cast<double>(count_drawn());
  EXPECT_LT(error / pixels / 3, 3);
  EXPECT_LT(depth_error_m / pixels, 0.02);
}

// Steel mirrors something else for each camera.
TEST_F(Gaps, AreLeftWhereTheUsersPictureContradicts) {
  look(is_in_band);
  Image<Bgr> color = seen->frame.rgbd[0].color.own();
  for (std::size_t i = 0; i < color.size(); ++i) {
    Bgr& pixel = color.data()[i];
    pixel.b = static_cast<std::uint8_t>(std::min(255, pixel.b + 40));
  }
  seen->frame.rgbd[0].color = std::move(color);
  draw();
  EXPECT_EQ(count_drawn(), 0U);
}

TEST_F(Gaps, AreLeftWhereTheUsersPictureShowsNothingOfThem) {
  look([](const AnalyticScene::Hit& hit) {
    return std::abs(hit.point.x()) < 0.04 && std::abs(hit.point.y()) < 0.04;
  });
  EXPECT_GT(hidden_bare, 100U);
  draw();
  EXPECT_EQ(count_drawn(), 0U);
}

// The surface may be anywhere between the depths around it: its colour is not known.
TEST_F(Gaps, AreLeftWhereTheColorDependsOnTheDistance) {
  look(is_in_band);
  scene.wave_m = 0.02;
  const RgbdCamera& camera = seen->rig.rgbd[0];
  const RigidTransform camera_from_world =
      camera.color_from_depth * *seen->poses.depth_from_world[0];
  seen->frame.rgbd[0].color = scene.color_image(Lens(camera.color), camera_from_world);
  seen->frame.color = scene.color_image(Lens(seen->rig.color), *seen->poses.color_from_world);
  draw();
  EXPECT_LT(count_drawn(), hidden_bare / 10);
}

}  // namespace
}  // namespace diminish
