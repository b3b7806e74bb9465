#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "diminish/frame_set.h"
#include "diminish/intrinsics.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/reconstructor.h"
#include "diminish/rig.h"

namespace diminish::testing {

/// A wall (the plane z = 0) and a box in front of it, with smooth colours that are known at every
/// point, seen by a colour camera and an RGB-D camera at known places. Every image is exact: one
/// ray through the lens model per pixel.
struct AnalyticScene {
  Eigen::Vector3d box_min{-0.15, -0.1, 0.2};
  Eigen::Vector3d box_max{0.15, 0.1, 0.4};
  bool has_box = true;
  double wave_m = 0.06;  ///< of the wall's pattern

  struct Hit {
    Eigen::Vector3d point;
    bool on_box;
  };

  /// Where a ray from `origin` first meets a surface.
  Hit cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    const double wall = -origin.z() / direction.z();
    if (has_box) {
      double enter = -std::numeric_limits<double>::infinity();
      double leave = std::numeric_limits<double>::infinity();
      for (int axis = 0; axis < 3; ++axis) {
        const double a = (box_min[axis] - origin[axis]) / direction[axis];
        const double b = (box_max[axis] - origin[axis]) / direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (enter < leave && enter > 0) return {origin + enter * direction, true};
    }
    return {origin + wall * direction, false};
  }

  /// The brightness changes by several levels per pixel: a shift of a tenth of a pixel shows.
  Eigen::Vector3d color(const Hit& hit) const {
    const Eigen::Vector3d& p = hit.point;
    const double wave = 2 * std::numbers::pi / wave_m;
    if (hit.on_box) {
      const double x = p.x() - (box_min.x() + box_max.x()) / 2;
      return {30, 40 + 15 * std::sin(wave * (x + p.z())), 220};
    }
    return {128 + 60 * std::sin(wave * p.x()), 128 + 60 * std::sin(wave * p.y()), 90};
  }

  template <class Visit>
  void render(const Lens& lens, const RigidTransform& camera_from_world, Visit&& visit) const {
    const RigidTransform world_from_camera = camera_from_world.inverse();
    for (int y = 0; y < lens.intrinsics().height; ++y) {
      for (int x = 0; x < lens.intrinsics().width; ++x) {
        const Eigen::Vector2d ray = lens.undistort(Eigen::Vector2d(x, y));
        visit(x, y,
              cast(world_from_camera.translation, world_from_camera.rotation * ray.homogeneous()));
      }
    }
  }

  Image<Bgr> color_image(const Lens& lens, const RigidTransform& camera_from_world) const {
    Image<Bgr> image(lens.intrinsics().width, lens.intrinsics().height);
    render(lens, camera_from_world, [&](int x, int y, const Hit& hit) {
      const Eigen::Vector3d c = color(hit);
      const auto level = [](double value) {
        return static_cast<std::uint8_t>(std::lrint(std::clamp(value, 0.0, 255.0)));
      };
      image(x, y) = {level(c[0]), level(c[1]), level(c[2])};
    });
    return image;
  }

  Image<std::uint16_t> depth_image(const Lens& lens, const RigidTransform& depth_from_world,
                                   double depth_unit_m) const {
    Image<std::uint16_t> image(lens.intrinsics().width, lens.intrinsics().height);
    render(lens, depth_from_world, [&](int x, int y, const Hit& hit) {
      image(x, y) =
          static_cast<std::uint16_t>(std::lrint((depth_from_world * hit.point).z() / depth_unit_m));
    });
    return image;
  }
};

/// camera_from_world of a camera at `eye` that looks at `target`, with the world's y upwards.
inline RigidTransform look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitY()).normalized();
  RigidTransform camera_from_world;
  camera_from_world.rotation.row(0) = right;
  camera_from_world.rotation.row(1) = forward.cross(right);
  camera_from_world.rotation.row(2) = forward;
  camera_from_world.translation = -(camera_from_world.rotation * eye);
  return camera_from_world;
}

/// Cameras with lenses, a baseline and a rotation between depth and colour sensor.
inline Rig small_rig(int rgbd_count = 1, LensModel model = LensModel::plumb_bob) {
  Rig rig;
  rig.color = {320, 256, 283, 282, 161, 127, {-0.11, 0.09, 0.0006, -0.0004, 0}};
  RgbdCamera camera;
  camera.color = {480, 270, 265, 265, 239, 135, {0.041, -0.045, -0.0003, 0.0005, 0}};
  camera.depth = {256, 212, 183, 183, 127.5, 103, {0.0893, -0.268, 0, 0, 0.089}};
  if (model == LensModel::rational) {
    rig.color.distortion = {0.3, 0.1, 0.0006, -0.0004, 0.02, 0.55, 0.12, 0.03};
    camera.color.distortion = {0.46, 0.05, -0.0003, 0.0005, 0.01, 0.6, 0.1, 0.01};
    camera.depth.distortion = {0.1, 0.2, 0.0002, 0.0001, 0.03, 0.2, 0.3, 0.02};
  } else if (model == LensModel::fisheye) {
    rig.color.fx = rig.color.fy = 230;
    rig.color.distortion = {0.02, -0.01, 0.003, -0.001};
    camera.color.fx = camera.color.fy = 310;
    camera.color.distortion = {-0.03, 0.02, -0.01, 0.002};
    camera.depth.fx = camera.depth.fy = 200;
    camera.depth.distortion = {-0.008, 0.045, -0.043, 0.008};
  }
  for (Intrinsics* sensor : {&rig.color, &camera.color, &camera.depth}) sensor->lens_model = model;
  camera.depth_unit_m = 0.0001;
  camera.color_from_depth.rotation =
      Eigen::AngleAxisd(0.01, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  camera.color_from_depth.translation = {0.052, -0.0006, -0.0013};
  for (int k = 0; k < rgbd_count; ++k) {
    camera.name = "rgbd" + std::to_string(k);
    rig.rgbd.push_back(camera);
  }
  return rig;
}

constexpr LensModel lens_models[] = {LensModel::plumb_bob, LensModel::rational, LensModel::fisheye};

/// The cameras' poses and images in the scene.
struct AnalyticFrame {
  Rig rig;
  Poses poses;
  FrameSet frame;

  AnalyticFrame(const AnalyticScene& scene, const std::vector<Eigen::Vector3d>& rgbd_eyes,
                LensModel model = LensModel::plumb_bob,
                const Eigen::Vector3d& color_eye = {0.05, 0.02, 1.2})
      : rig(small_rig(static_cast<int>(rgbd_eyes.size()), model)) {
    poses.color_from_world = look_at(color_eye, {0, 0, 0});
    frame.name = "000000";
    frame.color = scene.color_image(Lens(rig.color), *poses.color_from_world);
    for (std::size_t k = 0; k < rgbd_eyes.size(); ++k) {
      const RgbdCamera& camera = rig.rgbd[k];
      const RigidTransform depth_from_world = look_at(rgbd_eyes[k], {0, 0, 0});
      poses.depth_from_world.emplace_back(depth_from_world);
      poses.color_from_depth.emplace_back(*poses.color_from_world * depth_from_world.inverse());
      RgbdFrame rgbd;
      rgbd.depth = scene.depth_image(Lens(camera.depth), depth_from_world, camera.depth_unit_m);
      rgbd.color =
          scene.color_image(Lens(camera.color), camera.color_from_depth * depth_from_world);
      frame.rgbd.push_back(std::move(rgbd));
    }
  }
};

/// Empty masks of the rig's sizes.
inline OcclusionMasks empty_masks(const Rig& rig) {
  OcclusionMasks masks;
  masks.color.resize(rig.color.width, rig.color.height, 0);
  for (const RgbdCamera& camera : rig.rgbd) {
    masks.rgbd_color.emplace_back(camera.color.width, camera.color.height, std::uint8_t{0});
    masks.rgbd_depth.emplace_back(camera.depth.width, camera.depth.height, std::uint8_t{0});
  }
  return masks;
}

/// The depth images as they are.
inline DepthImages depths_of(const FrameSet& frame) {
  DepthImages depths;
  for (const RgbdFrame& rgbd : frame.rgbd) copy(rgbd.depth.view(), depths.emplace_back());
  return depths;
}

}  // namespace diminish::testing
