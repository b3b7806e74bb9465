#include "depth/depth_cleaner.h"

#include <gtest/gtest.h>

#include <random>

#include "analytic_scene.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

const Eigen::Vector3d eye(-0.45, 0.3, 0.9);

/// Without EdgeSnapping, which has its own tests.
Options without_snapping() {
  Options options;
  options.snap_edges = false;
  return options;
}

Image<std::uint16_t> cleaned(const AnalyticFrame& frame, const Rect& part, const Options& options) {
  const OcclusionMasks masks = testing::empty_masks(frame.rig);
  const RgbdFrame& rgbd = frame.frame.rgbd[0];
  Image<std::uint16_t> result;
  DepthCleaner(frame.rig.rgbd[0])
      .clean(rgbd.depth, {rgbd.color, masks.rgbd_color[0], masks.rgbd_depth[0]}, part, options,
             result);
  return result;
}
Image<std::uint16_t> cleaned(const AnalyticFrame& frame, const Options& options = {}) {
  const RgbdCamera& camera = frame.rig.rgbd[0];
  return cleaned(frame, camera.depth.bounds(), options);
}

// Against a ray caster: the colour sensor must see what is left of the wall, and what it sees must
// be left.
TEST(DepthCleaner, LeavesWhatTheColorSensorSees) {
  AnalyticScene scene;
  scene.box_max.z() = 0.5;  // further from the wall, so that much is hidden
  const AnalyticFrame frame(scene, {eye});
  const RgbdCamera& camera = frame.rig.rgbd[0];
  const RigidTransform depth_from_world = *frame.poses.depth_from_world[0];
  const RigidTransform color_from_world = camera.color_from_depth * depth_from_world;
  const Eigen::Vector3d color_eye = color_from_world.inverse().translation;
  const Image<std::uint16_t> result = cleaned(frame, without_snapping());
  int hidden = 0;
  int hidden_and_left = 0;
  int seen = 0;
  int seen_and_gone = 0;
  scene.render(Lens(camera.depth), depth_from_world,
               [&](int x, int y, const AnalyticScene::Hit& hit) {
                 if (hit.on_box) return;
                 const auto first = scene.cast(color_eye, hit.point - color_eye);
                 const bool is_hidden = (first.point - hit.point).norm() > 1e-6;
                 (is_hidden ? hidden : seen) += 1;
                 hidden_and_left += is_hidden && result(x, y) != 0 ? 1 : 0;
                 seen_and_gone += !is_hidden && result(x, y) == 0 ? 1 : 0;
               });
  ASSERT_GT(hidden, 300);
  // Rows are not quite parallel to the line between the sensors.
  EXPECT_LT(hidden_and_left, hidden / 20);
  // The margin is a pixel wide, along the box's height.
  EXPECT_LT(seen_and_gone, seen / 100);
}

TEST(DepthCleaner, TakesOutWhatLiesBetweenTwoSurfaces) {
  AnalyticScene scene;
  AnalyticFrame frame(scene, {eye});
  Image<std::uint16_t>& depth = frame.frame.rgbd[0].depth.own();
  // Wherever the box ends, a pixel half way to the wall.
  std::vector<std::pair<int, int>> flying;
  const Image<std::uint16_t> exact = depth;
  for (int y = 3; y < depth.height() - 3; ++y) {
    for (int x = 4; x < depth.width() - 4; ++x) {
      if (std::abs(exact(x, y) - exact(x + 1, y)) < 1000) continue;
      depth(x, y) = static_cast<std::uint16_t>((exact(x, y) + exact(x + 1, y)) / 2);
      flying.emplace_back(x, y);
      break;
    }
  }
  ASSERT_GT(flying.size(), 40U);
  const Image<std::uint16_t> result = cleaned(frame, without_snapping());
  for (const auto& [x, y] : flying) EXPECT_EQ(result(x, y), 0) << x << ' ' << y;
}

TEST(DepthCleaner, LeavesASlantedWallAlone) {
  AnalyticScene scene;
  scene.has_box = false;
  const AnalyticFrame frame(scene, {Eigen::Vector3d(-0.8, 0.1, 0.7)});
  const Image<std::uint16_t> depth = testing::depths_of(frame.frame)[0];
  Options options;
  options.smooth_depth = false;
  const Image<std::uint16_t> result = cleaned(frame, options);
  // At its far end the wall is seen from its edge, and beyond what 16 bits hold.
  const double far = 2.5 / frame.rig.rgbd[0].depth_unit_m;
  int near_pixels = 0;
  int gone = 0;
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width() / 2; ++x) {
      if (depth(x, y) > far) continue;
      ++near_pixels;
      gone += result(x, y) != depth(x, y) ? 1 : 0;
    }
  }
  EXPECT_GT(near_pixels, 20000);
  EXPECT_EQ(gone, 0);
}

// Noise shrinks, also on a slanted wall, and edges stay where they are.
TEST(DepthCleaner, SmoothsNoiseOnSurfaces) {
  AnalyticScene scene;
  AnalyticFrame frame(scene, {eye});
  Image<std::uint16_t>& depth = frame.frame.rgbd[0].depth.own();
  const Image<std::uint16_t> exact = depth;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 20);  // 2 mm
  for (std::uint16_t& value : depth) value = static_cast<std::uint16_t>(value + noise(random));
  const Image<std::uint16_t> result = cleaned(frame, without_snapping());
  double before = 0;
  double after = 0;
  int count = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (result.data()[i] == 0) continue;
    before += std::pow(depth.data()[i] - exact.data()[i], 2);
    after += std::pow(result.data()[i] - exact.data()[i], 2);
    ++count;
  }
  ASSERT_GT(count, 40000);
  // 25 pixels: a fifth; more where edges leave fewer.
  EXPECT_LT(std::sqrt(after / count), 0.4 * std::sqrt(before / count));
}

TEST(DepthCleaner, ChangesOnlyItsPartAndCanBeSwitchedOff) {
  AnalyticScene scene;
  const AnalyticFrame frame(scene, {eye});
  Options off;
  off.remove_flying = off.remove_hidden = off.smooth_depth = off.snap_edges = false;
  const Image<std::uint16_t> depth = testing::depths_of(frame.frame)[0];
  EXPECT_EQ(cleaned(frame, off), depth);
  ASSERT_NE(cleaned(frame), depth);
  const Rect corner{0, 0, 20, 20};
  const Image<std::uint16_t> result = cleaned(frame, corner, {});
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      if (corner.contains(x, y)) continue;
      ASSERT_EQ(result(x, y), depth(x, y));
    }
  }
}

}  // namespace
}  // namespace diminish
