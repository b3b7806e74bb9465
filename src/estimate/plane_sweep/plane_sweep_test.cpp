#include "estimate/plane_sweep/plane_sweep.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "each_vector_target.h"

namespace diminish {
namespace {

/// A slanted wall, z = 1.4 + 0.3 x, painted with a texture of its own.
constexpr double wall_z = 1.4;
constexpr double wall_slope = 0.3;

double paint(double x, double y) {
  double level = 0;
  for (int i = 1; i <= 4; ++i) {
    level += std::sin(37.0 * i * x + 3 * i) * std::cos(29.0 * i * y + i * i * x * 11);
  }
  return 128 + 28 * level;
}

Intrinsics camera() {
  Intrinsics camera{.width = 400, .height = 300, .fx = 420, .fy = 425, .cx = 203, .cy = 148};
  camera.distortion = {-0.11, 0.09, 0.0006, -0.0004};
  return camera;
}

/// Where a ray from a point meets the wall, as a multiple of the ray.
double meet(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
  return (wall_z + wall_slope * from.x() - from.z()) / (ray.z() - wall_slope * ray.x());
}

Image<Bgr> look(const RigidTransform& world_from_camera) {
  const Lens lens(camera());
  Image<Bgr> picture(camera().width, camera().height);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const Eigen::Vector2d at = lens.undistort({x, y});
      const Eigen::Vector3d ray = world_from_camera.rotation * Eigen::Vector3d(at.x(), at.y(), 1);
      const Eigen::Vector3d& from = world_from_camera.translation;
      const Eigen::Vector3d point = from + meet(from, ray) * ray;
      const auto level =
          static_cast<std::uint8_t>(std::clamp(paint(point.x(), point.y()), 1.0, 255.0));
      picture(x, y) = {level, level, level};
    }
  }
  return picture;
}

/// The first camera is the world; the second stands beside it, turned a little.
RigidTransform world_from_second() {
  RigidTransform transform;
  transform.rotation = (Eigen::AngleAxisd(-0.08, Eigen::Vector3d::UnitY()) *
                        Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitZ()))
                           .toRotationMatrix();
  transform.translation = {0.15, 0.01, -0.03};
  return transform;
}

Intrinsics pinhole() {
  Intrinsics view = camera();
  view.distortion = {};
  return view;
}

GreyPicture grey(const Image<Bgr>& picture) {
  GreyPicture grey(camera(), 1);
  grey.take(picture);
  return grey;
}

struct Errors {
  int found = 0, right = 0, all = 0;
};

/// In pixels of disparity, of the pixels inside `part`.
Errors compare(const Image<float>& inverse_depth, const Rect& part) {
  const Intrinsics view = pinhole();
  Errors errors;
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int x = part.x; x < part.right(); ++x) {
      const Eigen::Vector3d ray((x - view.cx) / view.fx, (y - view.cy) / view.fy, 1);
      const double truth = 1 / meet(Eigen::Vector3d::Zero(), ray);
      ++errors.all;
      if (!(inverse_depth(x, y) > 0)) continue;
      ++errors.found;
      if (std::abs(inverse_depth(x, y) - truth) * view.fx * 0.15 < 0.5) ++errors.right;
    }
  }
  return errors;
}

constexpr Rect middle = {90, 30, 270, 240};  ///< what both cameras see

TEST(PlaneSweep, MeasuresASlantedWallToHalfAPixel) {
  const GreyPicture first = grey(look({}));
  const GreyPicture second = grey(look(world_from_second()));
  PlaneSweep sweep(pinhole());
  Image<float> inverse_depth;
  sweep.sweep(first, second, world_from_second().inverse(), {0.8, 4}, pinhole().bounds(),
              inverse_depth);
  const Errors errors = compare(inverse_depth, middle);
  EXPECT_GT(errors.found, errors.all * 98 / 100);
  EXPECT_GT(errors.right, errors.found * 97 / 100);
}

TEST(PlaneSweep, IsTheSameOnAllMachines) {
  std::optional<Image<float>> same;
  testing::on_each_vector_target([&] {
    const GreyPicture first = grey(look({}));
    const GreyPicture second = grey(look(world_from_second()));
    PlaneSweep sweep(pinhole());
    Image<float> inverse_depth;
    sweep.sweep(first, second, world_from_second().inverse(), {1, 3}, pinhole().bounds(),
                inverse_depth);
    if (!same) same = inverse_depth;
    EXPECT_EQ(inverse_depth, *same);
  });
}

TEST(PlaneSweep, SweepsAPartOnly) {
  const GreyPicture first = grey(look({}));
  const GreyPicture second = grey(look(world_from_second()));
  PlaneSweep sweep(pinhole());
  Image<float> inverse_depth;
  const Rect part = {151, 83, 60, 71};
  sweep.sweep(first, second, world_from_second().inverse(), {0.8, 4}, part, inverse_depth);
  EXPECT_EQ(intersect(sweep.swept(), part), part);
  EXPECT_LT(sweep.swept().width, part.width + 3);
  const Errors errors = compare(inverse_depth, {160, 90, 40, 50});
  EXPECT_GT(errors.right, errors.all * 95 / 100);
}

TEST(PlaneSweep, FindsNothingBehindTheOtherCamera) {
  const GreyPicture first = grey(look({}));
  RigidTransform ahead;
  ahead.translation = {0, 0, 5};  // beyond the range
  PlaneSweep sweep(pinhole());
  Image<float> inverse_depth;
  sweep.sweep(first, first, ahead.inverse(), {0.8, 4}, pinhole().bounds(), inverse_depth);
  EXPECT_TRUE(sweep.swept().empty());
  EXPECT_EQ(inverse_depth, Image<float>(400, 300, 0));
}

}  // namespace
}  // namespace diminish
