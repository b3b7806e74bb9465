#pragma once

#include <random>
#include <utility>
#include <vector>

#include "analytic_scene.h"
#include "scene/background_planes.h"

namespace diminish::testing {

/// The wall under two lamps and the sky, with the box in front as the object to remove.
struct LitWall {
  LitWall() {
    plane = {(color_from_world.rotation * Eigen::Vector3d::UnitZ()).cast<float>(), 0};
    plane.distance_m = plane.normal.dot(color_from_world.translation.cast<float>());
    sample_wall();
    const Eigen::Vector3d size = scene.box_max - scene.box_min;
    for (int i = 0; i <= 10; ++i) {
      for (int j = 0; j <= 10; ++j) {
        const double u = 0.1 * i;
        const double v = 0.1 * j;
        // The faces that cameras in front of it may see.
        for (const Eigen::Vector3d& at :
             {Eigen::Vector3d(u, v, 1), Eigen::Vector3d(0, u, v), Eigen::Vector3d(1, u, v),
              Eigen::Vector3d(u, 1, v), Eigen::Vector3d(u, 0, v)}) {
          const Eigen::Vector3d point = scene.box_min + size.cwiseProduct(at);
          box_points.emplace_back((color_from_world * point).cast<float>());
        }
      }
    }
  }

  /// By ray casting.
  double light_at(const Eigen::Vector3d& point) const {
    double light = 1;
    for (const auto& [place, share] : lamps) {
      // A square metre, sampled at nine points.
      for (const double u : {-0.4, 0.0, 0.4}) {
        for (const double v : {-0.4, 0.0, 0.4}) {
          const Eigen::Vector3d towards = place + Eigen::Vector3d(u, v, 0) - point;
          if (scene.cast(point, towards).on_box) light -= share / 9;
        }
      }
    }
    return light;
  }
  /// Call it again when the lamps have changed.
  void sample_wall() {
    samples.clear();
    for (int x = 0; x < 45; ++x) {
      for (int y = 0; y < 35; ++y) add_sample({0.04 * x - 0.9, 0.04 * y - 0.7, 0});
    }
  }
  void add_sample(const Eigen::Vector3d& point) {
    SceneSample sample;
    sample.point_m = (color_from_world * point).cast<float>();
    sample.source = 1;
    const double level =
        150 * (1 + 0.2 * point.x() - 0.1 * point.y()) * light_at(point) + noise(random);
    const auto to_level = [](double value) {
      return static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
    };
    sample.color = {to_level(0.8 * level), to_level(level), to_level(0.9 * level)};
    samples.push_back(sample);
  }
  /// Where the colour camera looks through the box at the wall.
  Reconstruction wall() const {
    Reconstruction result;
    result.region = rig.color.bounds();
    result.depth_m.resize(rig.color.width, rig.color.height, 0.F);
    return result;
  }
  Surfaces wall_surfaces() const {
    Surfaces result;
    result.region = rig.color.bounds();
    result.label.resize(rig.color.width, rig.color.height, surface_label::first_plane);
    return result;
  }

  const Rig rig = small_rig();
  const RigidTransform color_from_world = look_at({0.2, 0.5, 1.6}, {0, 0, 0});
  AnalyticScene scene;
  std::pair<Eigen::Vector3d, double> lamps[2] = {{{1, 1.4, 2}, 0.4}, {{-1.2, 0.6, 2.2}, 0.25}};
  BackgroundPlane plane;
  std::vector<SceneSample> samples;
  std::vector<Eigen::Vector3f> box_points;
  std::mt19937 random{9};
  std::normal_distribution<double> noise{0, 4};
};

}  // namespace diminish::testing
