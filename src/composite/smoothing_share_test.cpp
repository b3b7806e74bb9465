#include "composite/smoothing_share.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "analytic_scene.h"
#include "composite/color_smoothing.h"
#include "core/channels.h"
#include "core/mat.h"
#include "diminish/diminished_frame.h"
#include "diminish/reconstructor.h"
#include "scene/scene_sampler.h"
#include "score/image_quality.h"

namespace diminish {
namespace {

constexpr int whole = ColorSmoothing::whole_change;

/// A wall with a pattern, seen by both cameras; `noise`: in levels, of both.
struct PatternedWall : testing::AnalyticFrame {
  explicit PatternedWall(double noise) : AnalyticFrame({.has_box = false}, {{-0.1, 0.05, 1.1}}) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal(0, noise);
    const auto add = [&](Image<Bgr>& image) {
      const auto level = [&](std::uint8_t value) {
        return static_cast<std::uint8_t>(std::clamp(std::lround(value + normal(random)), 0L, 255L));
      };
      for (Bgr& color : image) color = {level(color.b), level(color.g), level(color.r)};
    };
    if (noise > 0) {
      add(frame.color.own());
      add(frame.rgbd[0].color.own());
    }
    SceneSampler(rig).sample(frame, poses, testing::empty_masks(rig), samples);
  }
  int share(const Mask& occlusion) const {
    return smoothing_share(rig, frame, occlusion, samples.surfaces, std::vector<ColorMap>(256));
  }
  int share() const { return share(Mask(rig.color.width, rig.color.height, 0)); }

  SceneSamples samples;
};

/// The share that brings what is drawn of the RGB-D camera's images closest to the truth.
double best_share(const PatternedWall& wall, const PatternedWall& clean) {
  const Rect view = wall.rig.color.bounds();
  Reconstruction drawn;
  Registry<Reconstructor>::get("cpu")(wall.rig)->reconstruct(
      wall.frame, testing::depths_of(wall.frame), wall.poses, testing::empty_masks(wall.rig),
      TiledRegion(view), {}, drawn);
  Image<Bgr> noisy(view.width, view.height);
  std::transform(drawn.color.begin(), drawn.color.end(), noisy.begin(), [](const Bgra& color) {
    return Bgr{color.b, color.g, color.r};
  });
  Image<Bgr> smoothed = noisy;
  ColorSmoothing().smooth(drawn.source, view, whole, smoothed);
  double change_residual = 0;
  double change_change = 0;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      if (drawn.source(x, y) == 0) continue;
      const Eigen::Array3f own = to_channels(noisy(x, y));
      const Eigen::Array3f change = to_channels(smoothed(x, y)) - own;
      change_residual += (change * (to_channels(clean.frame.color(x, y)) - own)).sum();
      change_change += change.square().sum();
    }
  }
  return whole * std::clamp(change_residual / change_change, 0.0, 1.0);
}

TEST(SmoothingShare, IsTheBestByTheTruth) {
  const PatternedWall clean(0);
  double last = -1;
  for (const double noise : {0.5, 2.0, 4.0, 8.0}) {
    const PatternedWall wall(noise);
    const double best = best_share(wall, clean);
    EXPECT_NEAR(wall.share(), best, whole / 6.0) << "noise " << noise;
    EXPECT_GT(best, last);
    last = best;
  }
  EXPECT_GT(last, 0.6 * whole);
}

TEST(SmoothingShare, IsAllWhereTooLittleIsSeen) {
  const PatternedWall wall(0);
  EXPECT_EQ(wall.share(Mask(wall.rig.color.width, wall.rig.color.height, 255)), whole);
}

// --- Textures without noise

/// The brightness at a place on the wall, in metres.
using Texture = std::function<double(double x, double y)>;

/// Oblique squares of a centimetre (two pixels), faint as noise.
double checks(double x, double y) {
  const double u = 0.8 * x + 0.6 * y;
  const double v = 0.8 * y - 0.6 * x;
  const double wave = 2 * std::numbers::pi / 0.02;
  return 120 + 8 * std::tanh(3 * std::sin(wave * u) * std::sin(wave * v));
}

/// Waves in all directions, from 20 cm to 1 cm, as strong as they are long: like nature.
double one_over_f(double x, double y) {
  double sum = 0;
  double angle = 1;
  double wave_m = 0.2;
  for (int wave = 0; wave < 32; ++wave, wave_m /= 1.1) {
    angle += 2.4;  // the golden angle: no direction comes again
    const double along = x * std::cos(angle) + y * std::sin(angle);
    sum += wave_m / 0.2 * std::sin(2 * std::numbers::pi / wave_m * along + angle);
  }
  return 120 + 14 * sum;
}

/// Grain of wood: fine in one direction.
double wood(double x, double y) {
  return 110 + 30 * std::sin(2 * std::numbers::pi / 0.012 * (y + 0.01 * std::sin(9 * x)));
}

/// The wall with another texture.
PatternedWall with(const Texture& texture) {
  PatternedWall wall(0);
  const testing::AnalyticScene scene{.has_box = false};
  const auto paint = [&](const Intrinsics& camera, const RigidTransform& camera_from_world,
                         Image<Bgr>& image) {
    scene.render(Lens(camera), camera_from_world,
                 [&](int x, int y, const testing::AnalyticScene::Hit& hit) {
                   const auto level = static_cast<std::uint8_t>(
                       std::lrint(std::clamp(texture(hit.point.x(), hit.point.y()), 0.0, 255.0)));
                   image(x, y) = {level, level, level};
                 });
  };
  const RgbdCamera& rgbd = wall.rig.rgbd[0];
  paint(wall.rig.color, *wall.poses.color_from_world, wall.frame.color.own());
  paint(rgbd.color, rgbd.color_from_depth * *wall.poses.depth_from_world[0],
        wall.frame.rgbd[0].color.own());
  wall.samples = {};
  SceneSampler(wall.rig).sample(wall.frame, wall.poses, testing::empty_masks(wall.rig),
                                wall.samples);
  return wall;
}

class CleanTexture : public ::testing::TestWithParam<std::pair<const char*, Texture>> {};

// No clean texture may lose more than .002 of its structure.
TEST_P(CleanTexture, IsKept) {
  PatternedWall wall = with(GetParam().second);
  const Image<Bgr>& truth = wall.frame.rgbd[0].color.own();
  const Mask seen(truth.width(), truth.height(), provenance::first_rgbd);
  const auto lost_by = [&](int share) {
    Image<Bgr> smoothed = truth;
    ColorSmoothing().smooth(seen, truth.bounds(), share, smoothed);
    return 1 - cv::mean(ssim_map(as_mat(smoothed), as_mat(truth)))[0];
  };
  EXPECT_GT(lost_by(whole), 0.003) << "there is something to lose";
  EXPECT_LT(lost_by(wall.share()), 0.002) << "share " << wall.share();
}

INSTANTIATE_TEST_SUITE_P(SmoothingShare, CleanTexture,
                         ::testing::Values(std::pair("checks", Texture(checks)),
                                           std::pair("one_over_f", Texture(one_over_f)),
                                           std::pair("wood", Texture(wood))),
                         [](const auto& tested) { return std::string(tested.param.first); });

TEST(SmoothingShare, KeepsATextureWithoutNoise) {
  PatternedWall wall(0);
  const Image<Bgr>& truth = wall.frame.rgbd[0].color.own();
  const Mask seen(truth.width(), truth.height(), provenance::first_rgbd);
  const auto lost_by = [&](int share) {
    Image<Bgr> smoothed = truth;
    ColorSmoothing().smooth(seen, truth.bounds(), share, smoothed);
    return 1 - cv::mean(ssim_map(as_mat(smoothed), as_mat(truth)))[0];
  };
  EXPECT_GT(lost_by(whole), 0.005);
  EXPECT_LT(lost_by(wall.share()), 0.002);
}

}  // namespace
}  // namespace diminish
