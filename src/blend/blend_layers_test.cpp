#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "blend/camera_blender.h"
#include "blend/layers.h"
#include "each_vector_target.h"

namespace diminish {
namespace {

constexpr int width = 182;
constexpr int height = 90;
constexpr Rect region{6, 3, 170, 83};
const Intrinsics color{width, height, 150, 150, 91, 45, {}};
constexpr float agreement_m = 0.03F;

/// Cameras on a circle around the line of sight to the picture's centre, 1 m away from it: the
/// angle there is the same for all.
struct Scene {
  std::vector<Layer> layers;
  std::vector<CameraPlace> places;
  std::vector<float> resolutions;

  void add_camera(float resolution, double distance_m = 1) {
    const double turn = 2 * static_cast<double>(layers.size());
    RigidTransform color_from_depth;
    color_from_depth.translation = {0.5 * std::cos(turn), 0.5 * std::sin(turn), 1 - distance_m};
    places.emplace_back(color_from_depth);
    resolutions.push_back(resolution);
    layers.emplace_back().clear(width, height, {0, 0, width, height});
  }
  void draw(std::size_t k, const Rect& part, float z_m) {
    for (int y = part.y; y < part.bottom(); ++y) {
      for (int x = part.x; x < part.right(); ++x) draw(k, x, y, z_m);
    }
  }
  void draw(std::size_t k, int x, int y, float z_m) {
    const float scale = std::sqrt(resolutions[k]);
    layers[k].depth_m(x, y) = z_m;
    layers[k].texture(x, y) = {scale * static_cast<float>(x), scale * static_cast<float>(y)};
    layers[k].color(x, y) = {static_cast<std::uint8_t>(100 + 40 * k), 0, 0, 255};
  }
};

Reconstruction empty_reconstruction() {
  Reconstruction result;
  result.region = region;
  result.color.resize(width, height, {});
  result.depth_m.resize(width, height, 0);
  result.source.resize(width, height, 0);
  result.second.color.resize(width, height, {});
  result.second.source.resize(width, height, 0);
  result.second.share.resize(width, height, 0);
  return result;
}

Reconstruction blend_plainly(Scene scene) {
  Reconstruction result = empty_reconstruction();
  std::vector<BlendedLayer> layers;
  for (std::size_t k = 0; k < scene.layers.size(); ++k) {
    layers.push_back({&scene.layers[k], scene.places[k], static_cast<std::uint8_t>(1 + k)});
  }
  blend_layers(layers, color, agreement_m, result);
  return result;
}

/// The same, except for looking up colours.
Reconstruction blend_in_vectors(const Scene& scene) {
  Reconstruction result = empty_reconstruction();
  std::vector<SurfaceBuffer> buffers(scene.layers.size());
  std::vector<CameraBlender::Surface> surfaces(scene.layers.size());
  for (std::size_t k = 0; k < scene.layers.size(); ++k) {
    SurfaceBuffer& buffer = buffers[k];
    buffer.clear(region, region);
    for (int y = region.y; y < region.bottom(); ++y) {
      for (int x = region.x; x < region.right(); ++x) {
        const float z = scene.layers[k].depth_m(x, y);
        if (z == 0) continue;
        const auto i = static_cast<std::size_t>(buffer.row(y) + x - region.x);
        buffer.inverse_z[i] = 1 / z;
        buffer.u_over_z[i] = scene.layers[k].texture(x, y).x() / z;
        buffer.v_over_z[i] = scene.layers[k].texture(x, y).y() / z;
      }
      surfaces[k].rows.push_back(&buffer);
    }
    surfaces[k].source = static_cast<std::uint8_t>(1 + k);
    surfaces[k].place = scene.places[k];
  }
  CameraBlender blender;
  blender.begin(surfaces, region, color, agreement_m);
  CameraBlender::Scratch scratch;
  std::vector<float> second_depth_m(region.width);
  for (int y = region.y; y < region.bottom(); ++y) {
    blender.choose(y,
                   {result.source.row(y) + region.x, result.depth_m.row(y) + region.x,
                    result.second.source.row(y) + region.x, second_depth_m.data(),
                    result.second.share.row(y) + region.x},
                   scratch);
    for (int x = region.x; x < region.right(); ++x) {
      const auto look_up = [&](std::uint8_t source) {
        return source == 0 ? Bgra{} : scene.layers[source - 1U].color(x, y);
      };
      result.color(x, y) = look_up(result.source(x, y));
      result.second.color(x, y) = look_up(result.second.source(x, y));
    }
  }
  return result;
}

/// Both cameras' blue, mixed.
double mixed(const Reconstruction& r, int x, int y) {
  return r.color(x, y).b +
         (r.second.color(x, y).b - r.color(x, y).b) * (r.second.share(x, y) / 255.0);
}

class BlendLayers : public ::testing::TestWithParam<bool> {
 protected:
  static Reconstruction blend(const Scene& scene) {
    return GetParam() ? blend_in_vectors(scene) : blend_plainly(scene);
  }
};
INSTANTIATE_TEST_SUITE_P(Versions, BlendLayers, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "vectors" : "plain"; });

TEST_P(BlendLayers, MixesInPartsLikeTheConfidenceBeyondTheThirds) {
  Scene scene;
  for (const float resolution : {0.8F, 0.2F}) {
    scene.add_camera(resolution);
    scene.draw(scene.layers.size() - 1, {0, 0, width, height}, 1);
  }
  Reconstruction result = blend(scene);
  EXPECT_EQ(result.source(91, 45), 1);
  EXPECT_EQ(result.second.source(91, 45), 2);
  EXPECT_NEAR(result.second.share(91, 45), 255 * 0.2, 2);
  scene.add_camera(0.4F);
  scene.draw(2, {0, 0, width, height}, 1);
  result = blend(scene);
  EXPECT_EQ(result.source(91, 45), 1);
  EXPECT_EQ(result.second.source(91, 45), 3);
  EXPECT_NEAR(result.second.share(91, 45), 255 * (0.4 - 0.2) / (0.8 + 0.4 - 2 * 0.2), 3);
}

// Two cameras see a wall with 3 mm of noise, 40 levels apart; one of them sees half of it.
TEST_P(BlendLayers, ShowsNeitherSeamNorSpeckle) {
  Scene scene;
  scene.add_camera(1);
  scene.add_camera(0.7F);
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0, 0.003F);
  constexpr int edge = 103;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x < edge) scene.draw(0, x, y, 1 + noise(random));
      scene.draw(1, x, y, 1 + noise(random));
    }
  }
  const Reconstruction result = blend(scene);
  for (int y = region.y; y < region.bottom(); ++y) {
    int changes = 0;
    for (int x = region.x + 1; x < region.right(); ++x) {
      ASSERT_LT(std::abs(mixed(result, x, y) - mixed(result, x - 1, y)), 4) << x << ' ' << y;
      changes += result.source(x, y) != result.source(x - 1, y) ? 1 : 0;
    }
    EXPECT_EQ(changes, 1) << y;
    EXPECT_LT(mixed(result, region.x + 5, y), 125);
    EXPECT_NEAR(mixed(result, edge, y), 140, 1e-9);
  }
}

TEST_P(BlendLayers, DoesNotMixTheNearWithTheFar) {
  Scene scene;
  scene.add_camera(1);
  scene.add_camera(1);
  const Rect near{60, 30, 30, 25};
  scene.draw(0, near, 1);
  scene.draw(1, {0, 0, width, height}, 1.2F);
  const Reconstruction result = blend(scene);
  for (int y = region.y; y < region.bottom(); ++y) {
    for (int x = region.x; x < region.right(); ++x) {
      // A corner's neighbourhood is mostly another surface's.
      const int from_corner = std::min(std::abs(x - near.x), std::abs(x - near.right() + 1)) +
                              std::min(std::abs(y - near.y), std::abs(y - near.bottom() + 1));
      if (from_corner < 3) continue;
      ASSERT_EQ(result.source(x, y), near.contains(x, y) ? 1 : 2) << x << ' ' << y;
      ASSERT_EQ(result.second.share(x, y), 0);
    }
  }
}

TEST_P(BlendLayers, LeavesOutSliversThatAnotherCameraLooksPast) {
  Scene scene;
  scene.add_camera(1);
  scene.add_camera(1);
  scene.draw(0, {0, 0, width, height}, 1.5F);
  for (const int x : {40, 120}) scene.draw(0, {x, 10, x == 40 ? 2 : 12, 70}, 1);
  scene.draw(0, {80, 10, 2, 70}, 1);
  scene.draw(1, {0, 0, 70, height}, 1.5F);
  scene.draw(1, {110, 0, 72, height}, 1.5F);
  const Reconstruction result = blend(scene);
  for (int y = 20; y < 70; ++y) {
    EXPECT_EQ(result.source(40, y), 2) << "a sliver";
    EXPECT_EQ(result.depth_m(40, y), 1.5F);
    EXPECT_EQ(result.source(80, y), 1) << "nobody looks past it";
    EXPECT_EQ(result.depth_m(80, y), 1);
    for (int x = 120; x < 132; ++x) ASSERT_EQ(result.depth_m(x, y), 1) << x;
  }
}

// 5 cm: at 1 m two surfaces, at 3 m noise.
TEST_P(BlendLayers, AgreesWithinTheNoiseOfBoth) {
  for (const double distance_m : {1.0, 3.0}) {
    Scene scene;
    scene.add_camera(1, distance_m);
    scene.add_camera(1, distance_m);
    scene.draw(0, {0, 0, width, height}, 1);
    scene.draw(1, {0, 0, width, height}, 1.05F);
    EXPECT_EQ(blend(scene).second.share(91, 45) > 100, distance_m == 3.0);
  }
}

TEST(BlendLayers, VectorsDoWhatThePlainVersionDoes) {
  std::mt19937 random(2);
  std::normal_distribution<float> noise(0, 0.01F);
  std::uniform_int_distribution<int> part(0, 60);
  for (int round = 0; round < 5; ++round) {
    Scene scene;
    for (std::size_t k = 0; k < 3; ++k) {
      scene.add_camera(0.4F + 0.3F * static_cast<float>(k), 1 + 0.5 * static_cast<double>(k));
      const Rect drawn{part(random), part(random) / 4, 120, 70};
      const Rect near{40 + part(random), part(random), 5 + part(random) / 3, 20};
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          if (near.contains(x, y))
            scene.draw(k, x, y, 0.8F + noise(random));
          else if (drawn.contains(x, y))
            scene.draw(k, x, y, 1 + noise(random));
        }
      }
    }
    const Reconstruction plain = blend_plainly(scene);
    testing::on_each_vector_target([&] {
      const Reconstruction fast = blend_in_vectors(scene);
      int differences = 0;
      int mixtures = 0;
      for (int y = region.y; y < region.bottom(); ++y) {
        for (int x = region.x; x < region.right(); ++x) {
          ASSERT_EQ(fast.source(x, y) == 0, plain.source(x, y) == 0);
          mixtures += plain.second.share(x, y) > 0 ? 1 : 0;
          differences += std::abs(mixed(fast, x, y) - mixed(plain, x, y)) > 1 ||
                                 std::abs(fast.depth_m(x, y) - plain.depth_m(x, y)) > 0.05F
                             ? 1
                             : 0;
        }
      }
      EXPECT_GT(mixtures, 1000);
      // Where depths differ by just the limit for one surface, rounding decides.
      EXPECT_LE(differences, 10);
    });
  }
}

}  // namespace
}  // namespace diminish
