#include "scene/thing_light.h"

#include <gtest/gtest.h>

#include <functional>

#include "lit_wall.h"

namespace diminish {
namespace {

/// A flat thing in front of the lit wall, in the shadow of the box.
class ShadedThing : public ::testing::Test, protected testing::LitWall {
 protected:
  void SetUp() override {
    shadows_.find({plane}, samples, box_points);
    ASSERT_TRUE(shadows_.any());
  }
  Eigen::Vector3d in_world(const Eigen::Vector2f& ray, float inverse_depth) const {
    return color_from_world.inverse() * (ray.homogeneous() / inverse_depth).cast<double>();
  }
  /// Shades a plane through a point of the world that fills the picture, and calls
  /// visit(point, light left) for what lies within a distance of it.
  void shade(const Eigen::Vector3d& middle, const Eigen::Vector3d& normal, double distance_m,
             const std::function<void(const Eigen::Vector3d&, double)>& visit) {
    BackgroundPlane thing;
    thing.normal = (color_from_world.rotation * normal.normalized()).cast<float>();
    thing.distance_m = thing.normal.dot((color_from_world * middle).cast<float>());
    Reconstruction reconstruction = wall();
    Surfaces surfaces = wall_surfaces();
    surfaces.label.fill(surface_label::foreground);
    const Lens lens(rig.color);
    const auto inverse_depth = [&](int x, int y) {
      const Eigen::Vector2f ray = lens.undistort({x, y}).cast<float>();
      return thing.inverse_depth(ray.x(), ray.y());
    };
    for (int y = 0; y < rig.color.height; ++y) {
      for (int x = 0; x < rig.color.width; ++x) {
        const float inverse = inverse_depth(x, y);
        if (inverse > 0.1F) reconstruction.depth_m(x, y) = 1 / inverse;
      }
    }
    shadows_.shade(reconstruction, surfaces);
    for (const Bgr& light : surfaces.light) ASSERT_EQ(light, (Bgr{255, 255, 255}));
    light_.shade(shadows_.shadows(), shadows_.rays(), reconstruction.depth_m, surfaces);
    for (int y = 0; y < rig.color.height; ++y) {
      for (int x = 0; x < rig.color.width; ++x) {
        const float inverse = inverse_depth(x, y);
        if (!(inverse > 0.1F)) continue;
        const Eigen::Vector3d point = in_world(lens.undistort({x, y}).cast<float>(), inverse);
        if ((point - middle).norm() < distance_m) visit(point, surfaces.light(x, y).g / 255.0);
      }
    }
  }
  bool is_beside_box(const Eigen::Vector3d& point) const {
    const Eigen::Vector2d at = point.head<2>();
    return (at.array() < scene.box_min.head<2>().array() - 0.02).any() ||
           (at.array() > scene.box_max.head<2>().array() + 0.02).any();
  }
  /// Where the box takes most of the light, at a height.
  Eigen::Vector3d darkest(double height_m) const {
    Eigen::Vector3d found(0, 0, height_m);
    double least = 2;
    for (int x = -12; x < 12; ++x) {
      for (int y = -10; y < 10; ++y) {
        const Eigen::Vector3d point(0.05 * x, 0.05 * y, height_m);
        if (!is_beside_box(point) || light_at(point) >= least) continue;
        least = light_at(point);
        found = point;
      }
    }
    return found;
  }

  CastShadows shadows_{rig.color};
  ThingLight light_;
};

TEST_F(ShadedThing, LosesTheLightThatTheRayCasterSays) {
  double error = 0;
  double error_without = 0;
  shade({0, 0, 0.08}, Eigen::Vector3d::UnitZ(), 1, [&](const auto& point, double light) {
    if (!is_beside_box(point)) return;
    error += std::abs(light - light_at(point));
    error_without += 1 - light_at(point);
  });
  ASSERT_GT(error_without, 0);
  EXPECT_LT(error, 0.6 * error_without);
}

TEST_F(ShadedThing, KeepsItsLightWhereItFacesAwayFromTheLamp) {
  lamps[0] = {{1.3, 1.4, 1}, 0.5};
  lamps[1].second = 0;
  sample_wall();
  shadows_.find({plane}, samples, box_points);
  ASSERT_TRUE(shadows_.any());
  const Eigen::Vector3d middle = darkest(0.05);
  const auto lost = [&](const Eigen::Vector3d& normal) {
    double sum = 0;
    int count = 0;
    shade(middle, normal, 0.1, [&](const auto&, double light) {
      sum += 1 - light;
      ++count;
    });
    EXPECT_GT(count, 20);
    return sum / count;
  };
  // The camera sees it, the lamp does not.
  const Eigen::Vector3d away(-0.5, -0.5, 0.7);
  ASSERT_GT(away.dot(color_from_world.inverse().translation - middle), 0.2);
  ASSERT_LT(away.dot(lamps[0].first - middle), -0.3);
  const double lost_facing = lost(Eigen::Vector3d::UnitZ());
  EXPECT_GT(lost_facing, 0.1);
  EXPECT_LT(lost(away), 0.3 * lost_facing);
}

TEST_F(ShadedThing, KeepsItsLightAboveTheBox) {
  shade({0, 0, scene.box_max.z() + 0.03}, Eigen::Vector3d::UnitZ(), 1,
        [&](const auto&, double light) { ASSERT_EQ(light, 1); });
}

}  // namespace
}  // namespace diminish
