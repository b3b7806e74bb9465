#include <gtest/gtest.h>

#include <cmath>

#include "analytic_scene.h"
#include "diminish/reconstructor.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;
using testing::empty_masks;

const Eigen::Vector3d rgbd_eye(-0.45, 0.3, 0.9);

/// Every test runs with every backend.
class AnyReconstructor : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, AnyReconstructor,
                         ::testing::ValuesIn(Registry<Reconstructor>::names()),
                         [](const auto& test) { return test.param; });

Reconstruction reconstruct(const std::string& backend, const AnalyticFrame& scene,
                           const OcclusionMasks& masks, const Options& options) {
  Reconstruction result;
  Registry<Reconstructor>::get(backend)(scene.rig)->reconstruct(
      scene.frame, testing::depths_of(scene.frame), scene.poses, masks, scene.rig.color.bounds(),
      options, result);
  return result;
}

Reconstruction reconstruct(const AnalyticFrame& scene, const OcclusionMasks& masks,
                           const Options& options = {}) {
  return reconstruct(AnyReconstructor::GetParam(), scene, masks, options);
}

void draw_box(const AnalyticScene& scene, const Intrinsics& sensor,
              const RigidTransform& sensor_from_world, Mask& mask) {
  scene.render(Lens(sensor), sensor_from_world, [&](int x, int y, const AnalyticScene::Hit& hit) {
    mask(x, y) = hit.on_box ? 255 : 0;
  });
}

/// Whether a sensor at `sensor_from_world` has the point in its picture and nothing in front of it.
bool is_seen(const AnalyticScene& scene, const Lens& lens, const RigidTransform& sensor_from_world,
             const Eigen::Vector3d& point) {
  const auto pixel = lens.project(sensor_from_world * point);
  if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > lens.intrinsics().width - 1 ||
      pixel->y() > lens.intrinsics().height - 1) {
    return false;
  }
  const Eigen::Vector3d eye = sensor_from_world.inverse().translation;
  return (scene.cast(eye, point - eye).point - point).norm() < 1e-6;
}

class AnyReconstructorAndLens
    : public ::testing::TestWithParam<std::tuple<std::string, LensModel>> {};
INSTANTIATE_TEST_SUITE_P(Backends, AnyReconstructorAndLens,
                         ::testing::Combine(::testing::ValuesIn(Registry<Reconstructor>::names()),
                                            ::testing::ValuesIn(testing::lens_models)),
                         [](const auto& test) {
                           return std::get<0>(test.param) + "_" + name_of(std::get<1>(test.param));
                         });

// The whole chain (rays, transforms, three lenses, rasterisation, texture lookup) against a ray
// caster that shares none of it but the lenses.
TEST_P(AnyReconstructorAndLens, ShowsAPlaneAndABoxWhereTheyAre) {
  const AnalyticScene scene;
  const auto& [backend, model] = GetParam();
  const AnalyticFrame frame(scene, {rgbd_eye}, model);
  const Reconstruction result = reconstruct(backend, frame, empty_masks(frame.rig), {});

  const RgbdCamera& camera = frame.rig.rgbd[0];
  const Lens depth_lens(camera.depth);
  const Lens color_lens(camera.color);
  const RigidTransform depth_from_world = *frame.poses.depth_from_world[0];
  const RigidTransform color_from_world = camera.color_from_depth * depth_from_world;
  // 0: hidden from the depth sensor, 1: wall, 2: box, 3: only the colour sensor's view is blocked,
  // so that a wrong colour is looked up (what the colour masks are for).
  Image<std::uint8_t> expected(frame.rig.color.width, frame.rig.color.height);
  Image<float> exact_depth(frame.rig.color.width, frame.rig.color.height);
  scene.render(Lens(frame.rig.color), *frame.poses.color_from_world,
               [&](int x, int y, const AnalyticScene::Hit& hit) {
                 const bool in_depth = is_seen(scene, depth_lens, depth_from_world, hit.point);
                 const bool in_color = is_seen(scene, color_lens, color_from_world, hit.point);
                 expected(x, y) = !in_depth ? 0 : !in_color ? 3 : hit.on_box ? 2 : 1;
                 exact_depth(x, y) =
                     static_cast<float>((*frame.poses.color_from_world * hit.point).z());
               });
  // Pixels within a few pixels of an outline (the box's, the shadow's) are of either side.
  const auto uniform_around = [&](int x, int y) {
    if (expected(x, y) == 3) return false;
    constexpr int radius = 5;
    for (int dy = -radius; dy <= radius; ++dy) {
      for (int dx = -radius; dx <= radius; ++dx) {
        if (!expected.bounds().contains(x + dx, y + dy) ||
            expected(x + dx, y + dy) != expected(x, y)) {
          return false;
        }
      }
    }
    return true;
  };

  std::size_t drawn = 0;
  std::size_t hidden = 0;
  double color_squares = 0;
  double worst_depth = 0;
  double shift_numerator = 0;
  double shift_denominator = 0;
  for (int y = 1; y + 1 < expected.height(); ++y) {
    for (int x = 1; x + 1 < expected.width(); ++x) {
      if (!uniform_around(x, y)) continue;
      const Bgra& color = result.color(x, y);
      ASSERT_EQ(color.a, expected(x, y) != 0 ? 255 : 0) << x << ' ' << y;
      ASSERT_EQ(result.source(x, y), expected(x, y) != 0 ? 1 : 0);
      if (expected(x, y) == 0) {
        ++hidden;
        continue;
      }
      ++drawn;
      const Bgr& exact = frame.frame.color(x, y);
      const double error = color.b - exact.b;
      color_squares +=
          error * error + std::pow(color.g - exact.g, 2) + std::pow(color.r - exact.r, 2);
      worst_depth =
          std::max(worst_depth, std::abs(double{result.depth_m(x, y)} - exact_depth(x, y)));
      // A horizontal shift s changes the colour by s times its gradient (least squares for s).
      const double gradient = (frame.frame.color(x + 1, y).b - frame.frame.color(x - 1, y).b) / 2.0;
      shift_numerator += error * gradient;
      shift_denominator += gradient * gradient;
    }
  }
  EXPECT_GT(drawn, 25000U);
  EXPECT_GT(hidden, 1000U) << "the box's shadow must be in the picture";
  // Off its axis a fisheye pictures the pattern in half as many pixels.
  const double most_levels = model == LensModel::fisheye ? 2 : 1;
  EXPECT_LT(std::sqrt(color_squares / (3.0 * static_cast<double>(drawn))), most_levels);
  EXPECT_LT(std::abs(shift_numerator / shift_denominator), 0.02) << "pixels";
  EXPECT_LT(worst_depth, 0.0005) << "metres";
}

// Rule 1: depth pixels on the object are no vertices.
TEST_P(AnyReconstructor, LeavesOutDepthPixelsOnTheObject) {
  const AnalyticScene scene;
  const AnalyticFrame frame(scene, {rgbd_eye});
  OcclusionMasks masks = empty_masks(frame.rig);
  draw_box(scene, frame.rig.rgbd[0].depth, *frame.poses.depth_from_world[0], masks.rgbd_depth[0]);
  const Reconstruction result = reconstruct(frame, masks);
  std::size_t drawn = 0;
  const Lens lens(frame.rig.color);
  for (int y = 0; y < result.depth_m.height(); ++y) {
    for (int x = 0; x < result.depth_m.width(); ++x) {
      if (result.depth_m(x, y) == 0) continue;
      ++drawn;
      const Eigen::Vector2d ray = lens.undistort(Eigen::Vector2d(x, y));
      const Eigen::Vector3d point =
          frame.poses.color_from_world->inverse() *
          (double{result.depth_m(x, y)} * Eigen::Vector3d(ray.x(), ray.y(), 1));
      ASSERT_LT(std::abs(point.z()), 0.002) << "only the wall is left";
    }
  }
  EXPECT_GT(drawn, 20000U);
}

// Rule 1, second half: the sensors are 5 cm apart, so depth pixels of the wall beside the box look
// up the box's colour. With the colour mask none of it is left; without it there is some.
TEST_P(AnyReconstructor, LeavesOutDepthPixelsWhoseColorIsTheObjects) {
  const AnalyticScene scene;
  const AnalyticFrame frame(scene, {rgbd_eye});
  OcclusionMasks masks = empty_masks(frame.rig);
  draw_box(scene, frame.rig.rgbd[0].depth, *frame.poses.depth_from_world[0], masks.rgbd_depth[0]);
  const auto count_red = [&] {
    const Reconstruction result = reconstruct(frame, masks);
    return std::count_if(result.color.begin(), result.color.end(),
                         [](const Bgra& pixel) { return pixel.r > 150; });
  };
  EXPECT_GT(count_red(), 100);
  draw_box(scene, frame.rig.rgbd[0].color,
           frame.rig.rgbd[0].color_from_depth * *frame.poses.depth_from_world[0],
           masks.rgbd_color[0]);
  // Bilinear lookups reach half a pixel over the mask's edge.
  Mask grown = masks.rgbd_color[0];
  for (int y = 1; y + 1 < grown.height(); ++y) {
    for (int x = 1; x + 1 < grown.width(); ++x) {
      for (int i = 0; i < 9; ++i) {
        grown(x, y) |= masks.rgbd_color[0](x + i % 3 - 1, y + i / 3 - 1);
      }
    }
  }
  masks.rgbd_color[0] = grown;
  EXPECT_EQ(count_red(), 0);
}

TEST_P(AnyReconstructor, DrawsTheRegionAndNothingElse) {
  const AnalyticScene scene;
  const AnalyticFrame frame(scene, {rgbd_eye});
  const Reconstruction whole = reconstruct(frame, empty_masks(frame.rig));
  const auto reconstructor = Registry<Reconstructor>::get(GetParam())(frame.rig);
  const Rect region{40, 50, 100, 90};
  Reconstruction part;
  // Twice, so that what an earlier frame left behind would show.
  reconstructor->reconstruct(frame.frame, testing::depths_of(frame.frame), frame.poses,
                             empty_masks(frame.rig), Rect{0, 0, 200, 200}, {}, part);
  reconstructor->reconstruct(frame.frame, testing::depths_of(frame.frame), frame.poses,
                             empty_masks(frame.rig), region, {}, part);
  for (int y = 0; y < whole.color.height(); ++y) {
    for (int x = 0; x < whole.color.width(); ++x) {
      const Bgra expected = region.contains(x, y) ? whole.color(x, y) : Bgra{};
      ASSERT_EQ(part.color(x, y), expected) << x << ' ' << y;
    }
  }
}

TEST_P(AnyReconstructor, GoesOnWithoutACameraThatHasNoImagesOrNoPose) {
  const AnalyticScene scene;
  AnalyticFrame frame(scene, {rgbd_eye, {0.5, 0.3, 0.9}});
  const OcclusionMasks masks = empty_masks(frame.rig);
  const auto sources = [&] {
    bool seen[3] = {};
    for (const std::uint8_t source : reconstruct(frame, masks).source) seen[source] = true;
    return std::pair(seen[1], seen[2]);
  };
  EXPECT_EQ(sources(), std::pair(true, true));
  frame.frame.rgbd[0].missing = "rgbd0: unplugged";
  EXPECT_EQ(sources(), std::pair(false, true));
  frame.poses.color_from_depth[1].reset();
  EXPECT_EQ(sources(), std::pair(false, false));
}

// The same bytes as without it.
TEST_P(AnyReconstructor, ACameraThatSeesNothingOfTheRegionChangesNothing) {
  const AnalyticScene scene;
  AnalyticFrame frame(scene, {rgbd_eye, {0.5, 0.3, 0.9}});
  const OcclusionMasks masks = empty_masks(frame.rig);
  frame.frame.rgbd[1].depth.own().fill(0);
  const Reconstruction with = reconstruct(frame, masks);
  frame.frame.rgbd[1].missing = "rgbd1: unplugged";
  const Reconstruction without = reconstruct(frame, masks);
  EXPECT_EQ(with.color, without.color);
  EXPECT_EQ(with.depth_m, without.depth_m);
  EXPECT_EQ(with.source, without.source);
  EXPECT_TRUE(with.second.share.empty());
  EXPECT_TRUE(without.second.share.empty());
}

}  // namespace
}  // namespace diminish
