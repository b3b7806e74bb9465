#include "scene/surface_rows.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "scene/background_planes.h"

namespace diminish {
namespace {

class OnRandomRow : public ::testing::Test {
 protected:
  OnRandomRow() {
    for (float& z : depth_m) z = random() % 4 == 0 ? 0.F : uniform(0.5F, 4.F);
  }
  float uniform(float least, float most) {
    return std::uniform_real_distribution<float>(least, most)(random);
  }
  std::mt19937 random{5};
  std::vector<float> depth_m = std::vector<float>(31);
  const int count = static_cast<int>(depth_m.size());
};

// Against the rules, pixel by pixel in double precision.
TEST_F(OnRandomRow, LabelsAreThoseOfThePlanesNearby) {
  const DepthNoise tolerance{0.2F, 0.01F};
  const surface_rows::InverseDepth planes[] = {{0.4F, 0.003F}, {0.9F, -0.02F}, {-0.1F, 0.01F}};
  std::vector<std::uint8_t> labels(depth_m.size());
  std::vector<surface_rows::Segment> segments;
  for (int first = 0; const int length : {16, 3, 12}) {
    surface_rows::Segment& segment = segments.emplace_back();
    segment.count = length;
    for (std::size_t k = 0; k < segment.planes.size(); ++k) {
      const surface_rows::InverseDepth& plane = planes[k];
      segment.planes[k] = {plane.start + static_cast<float>(first) * plane.slope, plane.slope};
    }
    first += length;
  }
  surface_rows::label(depth_m.data(), segments, 3, tolerance, labels.data());
  int on_plane = 0;
  for (int i = 0; i < count; ++i) {
    const double z = depth_m[static_cast<std::size_t>(i)];
    int expected = z > 0 ? surface_label::foreground : surface_label::unknown;
    double nearest = 0;
    bool is_close_call = false;
    for (int k = 0; k < 3; ++k) {
      const double inverse = planes[k].start + i * static_cast<double>(planes[k].slope);
      if (z > 0) {
        const double off = std::abs(1 - inverse * z) * z - 2 * (0.2 + 0.01 * z * z);
        if (off <= 0) expected = surface_label::first_plane + k;
        is_close_call = is_close_call || std::abs(off) < 1e-5;
      } else if (inverse > nearest) {
        nearest = inverse;
        expected = surface_label::first_plane + k;
      }
    }
    on_plane += expected != surface_label::foreground ? 1 : 0;
    if (!is_close_call) {
      EXPECT_EQ(labels[static_cast<std::size_t>(i)], expected) << i;
    }
  }
  EXPECT_GT(on_plane, 5);
}

TEST_F(OnRandomRow, ShadowsFadeWithTheHeightAboveTheirPlane) {
  surface_rows::Shading shading;
  shading.label = 2;
  const BackgroundPlane plane{Eigen::Vector3f(0.1F, -0.6F, -0.79F).normalized(), -1.5F};
  const Eigen::Vector2f first_ray(-0.1F, 0.2F);
  const Eigen::Vector2f slope(0.002F, 0.0001F);
  shading.first = {0.6F, 0.3F, 0.1F, plane.normal.dot(first_ray.homogeneous())};
  shading.slope = {-0.01F, 0.005F, 0.002F, plane.normal.head<2>().dot(slope)};
  shading.distance_m = plane.distance_m;
  shading.fading_height = 0.6F;
  std::vector<std::uint8_t> labels(depth_m.size());
  for (int i = 0; i < count; ++i) {
    labels[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(random() % 4 == 0 ? 1 : 2);
    // Near the plane, most of them.
    if (depth_m[static_cast<std::size_t>(i)] == 0) continue;
    const Eigen::Vector2f ray = first_ray + static_cast<float>(i) * slope;
    depth_m[static_cast<std::size_t>(i)] =
        1 / plane.inverse_depth(ray.x(), ray.y()) + uniform(-0.02F, 0.06F);
  }
  std::vector<Bgr> light(depth_m.size());
  surface_rows::shade({&shading, 1}, depth_m.data(), labels.data(), count, light.data());
  int faded = 0;
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (labels[at] != 2) {
      EXPECT_EQ(light[at], (Bgr{255, 255, 255}));
      continue;
    }
    const double z = depth_m[at];
    double left = 1;
    if (z > 0) {
      const Eigen::Vector3d point =
          z * (first_ray + static_cast<float>(i) * slope).cast<double>().homogeneous();
      const double height = std::abs(plane.normal.cast<double>().dot(point) + 1.5);
      left = std::clamp(2 - height / (0.6 * (0.008 + 0.004 * z * z)), 0.0, 1.0);
    }
    faded += left < 1 ? 1 : 0;
    const int levels[] = {light[at].b, light[at].g, light[at].r};
    for (int c = 0; c < 3; ++c) {
      const double dark = left * (shading.first[c] + i * static_cast<double>(shading.slope[c]));
      EXPECT_NEAR(levels[c], 255 - 255 * dark, 0.51) << i;
    }
  }
  EXPECT_GT(faded, 3);
}

}  // namespace
}  // namespace diminish
