#include "composite/plane_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>

namespace diminish {
namespace {

constexpr int width = 560;
constexpr int height = 450;
constexpr Rect object{220, 160, 120, 110};
constexpr int wall_level = 120;

/// Brightness of the wall at a place on it, metres, less the mean.
using Grain = std::function<double(double x, double y)>;

/// Ripples of many lengths along one direction only, 8 to 16 mm (4 to 8 pixels) from crest to
/// crest.
double stripes(double across) {
  double sum = 0;
  for (int k = 0; k < 9; ++k) {
    sum += std::sin(across * 2 * M_PI / (0.016 - 0.001 * k) + 2.4 * k * k);
  }
  return 4 * sum;
}
constexpr double stripes_angle = 25 * M_PI / 180;
double striped(double x, double y) {
  return stripes(x * std::cos(stripes_angle) + y * std::sin(stripes_angle));
}

/// A wall that the colour camera looks at from aslant, a metre away. What the object hides was
/// filled with the wall's mean.
class Wall : public ::testing::Test {
 protected:
  Wall() {
    color.width = width;
    color.height = height;
    color.fx = color.fy = 500;
    color.cx = (width - 1) / 2.0;
    color.cy = (height - 1) / 2.0;
    occlusion.resize(width, height, 0);
    occlusion.fill(object, 255);
  }

  /// color_from_world: the wall is z = 0, its front towards the camera.
  static RigidTransform pose(double sideways_m) {
    const double turn = 0.3;
    RigidTransform camera;
    camera.rotation << std::cos(turn), 0, -std::sin(turn), 0, -1, 0, -std::sin(turn), 0,
        -std::cos(turn);
    camera.translation = {sideways_m, 0.02, 1};
    return camera;
  }

  void look(const Grain& grain, double sideways_m = 0) {
    color_from_world = pose(sideways_m);
    const Eigen::Vector3d normal = color_from_world->rotation.col(2);
    const double distance_m = normal.dot(color_from_world->translation);
    planes = {{normal.cast<float>(), static_cast<float>(distance_m)}};
    camera.resize(width, height);
    samples.clear();
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Eigen::Vector3d point = point_at(x, y);
        const Eigen::Vector3d place = color_from_world->inverse() * point;
        const auto level = static_cast<std::uint8_t>(
            std::clamp(std::lrint(wall_level + grain(place.x(), place.y())), 0L, 255L));
        camera(x, y) = {level, level, level};
        if (x % 12 != 0 || y % 12 != 0) continue;
        SceneSample sample;
        sample.point_m = point.cast<float>();
        sample.pixel = {static_cast<float>(x), static_cast<float>(y)};
        samples.push_back(sample);
      }
    }
    result.picture = camera;
    result.picture.fill(object, {wall_level, wall_level, wall_level});
    result.provenance.resize(width, height, provenance::camera);
    result.provenance.fill(object, provenance::inpainted);
    result.surfaces.region = result.picture.bounds();
    result.surfaces.label.resize(width, height, surface_label::first_plane);
    before = result.picture;
  }
  void add() {
    const PlaneTexture::Inputs inputs{camera, occlusion, object, planes, samples, color_from_world};
    texture.find(inputs, result);
    texture.add(inputs, result);
  }

  Eigen::Vector3d point_at(int x, int y) const {
    const Eigen::Vector3d ray((x - color.cx) / color.fx, (y - color.cy) / color.fy, 1);
    const Eigen::Vector3d normal = planes[0].normal.cast<double>();
    return ray * (static_cast<double>(planes[0].distance_m) / normal.dot(ray));
  }
  /// Root mean square of the differences to the wall's mean.
  double contrast(const Rect& part) const {
    double squares = 0;
    for (int y = part.y; y < part.bottom(); ++y) {
      for (int x = part.x; x < part.right(); ++x) {
        squares += std::pow(result.picture(x, y).g - wall_level, 2);
      }
    }
    return std::sqrt(squares / (part.width * part.height));
  }
  /// The direction of the strongest gradients, radians from the x axis, 0 to pi.
  double direction(const Rect& part) const {
    double xx = 0;
    double xy = 0;
    double yy = 0;
    for (int y = part.y + 1; y < part.bottom() - 1; ++y) {
      for (int x = part.x + 1; x < part.right() - 1; ++x) {
        const double dx = result.picture(x + 1, y).g - result.picture(x - 1, y).g;
        const double dy = result.picture(x, y + 1).g - result.picture(x, y - 1).g;
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
      }
    }
    const double angle = std::atan2(2 * xy, xx - yy) / 2;
    return angle < 0 ? angle + M_PI : angle;
  }

  Intrinsics color;
  Image<Bgr> camera, before;
  Mask occlusion;
  std::vector<BackgroundPlane> planes;
  std::vector<SceneSample> samples;
  std::optional<RigidTransform> color_from_world;
  DiminishedFrame result;
  PlaneTexture texture{[] {
    Intrinsics intrinsics;
    intrinsics.width = width;
    intrinsics.height = height;
    intrinsics.fx = intrinsics.fy = 500;
    intrinsics.cx = (width - 1) / 2.0;
    intrinsics.cy = (height - 1) / 2.0;
    return intrinsics;
  }()};
};

TEST_F(Wall, GrainHasTheWallsDirectionAndNearlyItsContrast) {
  look(striped);
  const Rect inside = grow(object, -8);
  ASSERT_EQ(contrast(inside), 0);
  add();
  const Rect beside{120, 160, 90, 110};
  // .7 of it is added, less the finest, which is taken for noise.
  EXPECT_GT(contrast(inside), 0.45 * contrast(beside));
  EXPECT_LT(contrast(inside), 0.75 * contrast(beside));
  const Rect around = grow(object, 30);
  result.picture = camera;
  const double expected = direction(around);
  look(striped);
  add();
  EXPECT_NEAR(direction(inside), expected, 0.08);
}

TEST_F(Wall, OnlyInventedPixelsOfAPlaneGetGrain) {
  look(striped);
  const Rect seen{240, 180, 30, 30};
  const Rect unknown{290, 180, 30, 30};
  result.provenance.fill(seen, provenance::first_rgbd);
  result.surfaces.label.fill(unknown, surface_label::unknown);
  add();
  int changed = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (result.picture(x, y) == before(x, y)) continue;
      ++changed;
      EXPECT_TRUE(object.contains(x, y) && !seen.contains(x, y) && !unknown.contains(x, y));
    }
  }
  EXPECT_GT(changed, object.width * object.height / 2);
}

TEST_F(Wall, GrainStaysWhereItIsOnTheWallWhenTheCameraMoves) {
  look(striped);
  add();
  const Image<Bgr> first = result.picture;
  const RigidTransform first_pose = *color_from_world;
  look(striped, 0.01);
  add();
  double products = 0;
  double squares = 0;
  double first_squares = 0;
  for (int y = object.y + 8; y < object.bottom() - 8; ++y) {
    for (int x = object.x + 8; x < object.right() - 8; ++x) {
      const Eigen::Vector3d point = first_pose * (color_from_world->inverse() * point_at(x, y));
      const int u = static_cast<int>(std::lrint(color.fx * point.x() / point.z() + color.cx));
      const int v = static_cast<int>(std::lrint(color.fy * point.y() / point.z() + color.cy));
      if (!grow(object, -2).contains(u, v)) continue;
      const double now = result.picture(x, y).g - wall_level;
      const double then = first(u, v).g - wall_level;
      products += now * then;
      squares += now * now;
      first_squares += then * then;
    }
  }
  EXPECT_GT(products / std::sqrt(squares * first_squares), 0.6);
}

TEST_F(Wall, EdgesAreNoGrain) {
  // Black bars, 2 cm wide, every 16 cm; between them ripples of few levels.
  look([](double x, double y) {
    const double along = std::fmod(std::abs(x) + 0.08, 0.16);
    return along < 0.02 ? -100.0 : striped(x, y) / 4;
  });
  add();
  for (int y = object.y; y < object.bottom(); ++y) {
    for (int x = object.x; x < object.right(); ++x) {
      ASSERT_NEAR(result.picture(x, y).g, wall_level, 25) << x << ", " << y;
    }
  }
  EXPECT_GT(contrast(object), 1);
}

TEST_F(Wall, StaysSmoothWhereNothingShowsItsGrain) {
  look(striped);
  samples.clear();
  add();
  EXPECT_EQ(result.picture, before);
  // Something stands in front of all of the wall that is seen.
  look(striped);
  for (SceneSample& sample : samples) sample.point_m *= 0.9F;
  add();
  EXPECT_EQ(result.picture, before);
}

}  // namespace
}  // namespace diminish
