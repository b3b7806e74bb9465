#include "scene/scene_fit.h"

#include <gtest/gtest.h>

#include <random>

namespace diminish {
namespace {

constexpr int width = 640;
constexpr int height = 480;

/// A picture of soft spots, and what two RGB-D cameras saw of it.
class SceneFitTest : public ::testing::Test {
 protected:
  SceneFitTest() : picture(width, height), occlusion(width, height) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> in_picture(0, width);
    std::vector<Eigen::Vector2d> spots(150);
    for (auto& spot : spots) spot = {in_picture(random), in_picture(random)};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double level = 60;
        for (const auto& spot : spots) {
          const double squared = (spot - Eigen::Vector2d(x, y)).squaredNorm();
          if (squared < 4000) level += 110 * std::exp(-squared / 300);
        }
        const auto grey = static_cast<std::uint8_t>(std::min(255., level));
        picture.row(y)[x] = {grey, grey, grey};
      }
    }
  }

  /// shift: of what the camera sees, pixels; gain: of its exposure.
  void add(std::uint8_t source, double shift, double gain) {
    for (int y = 4; y < height - 4; y += 8) {
      for (int x = 4; x < width - 4; x += 8) {
        SceneSample sample;
        sample.pixel = {static_cast<float>(x), static_cast<float>(y)};
        const int from = std::clamp(x + static_cast<int>(shift), 0, width - 1);
        const auto level = static_cast<std::uint8_t>(gain * picture.row(y)[from].g);
        sample.color = {level, level, level};
        sample.source = source;
        scene.surfaces.push_back(sample);
      }
    }
  }
  std::vector<std::optional<double>> fit() {
    std::vector<std::optional<double>> found(2);
    SceneFit({.width = width, .height = height}).find(picture, occlusion, scene, found);
    return found;
  }

  Image<Bgr> picture;
  Mask occlusion;
  SceneSamples scene;
};

TEST_F(SceneFitTest, TellsWhichCameraIsShifted) {
  add(1, 0, 0.6);
  add(2, 15, 1);
  const auto found = fit();
  ASSERT_TRUE(found[0] && found[1]);
  EXPECT_GT(*found[0], 0.95);
  EXPECT_LT(*found[1], 0.7);
}

TEST_F(SceneFitTest, FallsWithTheShift) {
  double last = 1;
  for (const int shift : {1, 4, 8, 16}) {
    scene.surfaces.clear();
    add(2, shift, 1);
    const auto found = fit();
    EXPECT_FALSE(found[0]);
    ASSERT_TRUE(found[1]);
    EXPECT_LT(*found[1], last);
    last = *found[1];
  }
}

TEST_F(SceneFitTest, IsUnknownWithoutTextureOrBehindObjects) {
  add(1, 0, 1);
  occlusion.fill(1);
  EXPECT_FALSE(fit()[0]);
  occlusion.fill(0);
  EXPECT_TRUE(fit()[0]);
  picture.fill(Bgr{90, 90, 90});
  EXPECT_FALSE(fit()[0]);
}

// The RGB-D camera sees the wall behind a thing that the colour camera sees in front of it.
TEST_F(SceneFitTest, SamplesBehindOthersAreLeftOut) {
  const auto set_depth = [this](float depth_m) {
    for (SceneSample& sample : scene.surfaces) {
      if (sample.source == 2) sample.point_m.z() = depth_m;
    }
  };
  add(1, 0, 1);
  for (SceneSample& sample : scene.surfaces) sample.point_m.z() = 1;
  add(2, 15, 1);
  set_depth(1.05F);
  EXPECT_TRUE(fit()[1]);
  set_depth(2);
  EXPECT_FALSE(fit()[1]);
  EXPECT_GT(*fit()[0], 0.95);
}

TEST_F(SceneFitTest, SamplesThatAreNowhereAreLeftOut) {
  add(1, 0, 1);
  const auto before = fit();
  for (SceneSample sample : std::vector(scene.surfaces)) {
    sample.pixel.setConstant(sample.color.b % 2 == 0 ? std::numeric_limits<float>::quiet_NaN()
                                                     : -1e30F);
    scene.surfaces.push_back(sample);
  }
  EXPECT_EQ(fit(), before);
}

}  // namespace
}  // namespace diminish
