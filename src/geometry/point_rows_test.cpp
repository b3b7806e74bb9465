#include "geometry/point_rows.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "each_vector_target.h"
#include "geometry/point_projection.h"

namespace diminish {
namespace {

Projection lens_of(LensModel model) {
  Intrinsics camera;
  camera.width = 90;
  camera.height = 70;
  camera.fx = 80;
  camera.fy = 82;
  camera.cx = 44;
  camera.cy = 33;
  camera.lens_model = model;
  camera.distortion = {-0.1, 0.02, 0.001, -0.002, 0.003};
  return Projection(Lens(camera));
}

/// Points in front of a camera, beside it and behind it; some are none.
struct Points {
  explicit Points(int count) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> ray(-0.7F, 0.7F);
    std::uniform_real_distribution<float> depth(0.1F, 4);
    for (int i = 0; i < count; ++i) {
      x.push_back(ray(random));
      y.push_back(ray(random));
      z.push_back(i % 7 == 3 ? 0 : depth(random));
    }
  }

  std::vector<float> x, y, z;
};

TEST(PointRows, FindTheSamePixelsOnEveryCpu) {
  RigidTransform transform;
  transform.rotation =
      Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  transform.translation = {0.3, -0.1, -0.8};
  const FloatTransform from_points(transform);
  constexpr Rect inside{5, 3, 70, 60};
  constexpr int pitch = 90;
  testing::on_each_vector_target([&] {
    for (const LensModel model : {LensModel::plumb_bob, LensModel::rational, LensModel::fisheye}) {
      const Projection lens = lens_of(model);
      for (const int count : {1, 3, 13, 257}) {
        const Points points(count);
        std::vector<std::int32_t> pixels(points.x.size());
        std::vector<float> depth_m(points.x.size());
        find_pixels({points.x.data(), points.y.data(), points.z.data(), count},
                    {from_points, lens, inside, pitch}, pixels.data(), depth_m.data());
        int found = 0;
        for (std::size_t i = 0; i < points.x.size(); ++i) {
          const float z = points.z[i];
          const Eigen::Vector3f there =
              diminish::transform(from_points, {points.x[i] * z, points.y[i] * z, z});
          const auto pixel = project(lens, there);
          const bool is_inside = z > 0 && pixel && inside.contains(pixel->x, pixel->y);
          ASSERT_EQ(pixels[i], is_inside ? pixel->y * pitch + pixel->x : -1)
              << i << " of " << count;
          if (!is_inside) continue;
          ASSERT_EQ(depth_m[i], there.z());
          ++found;
        }
        EXPECT_GE(found, count > 100 ? 20 : 0);
      }
    }
  });
}

}  // namespace
}  // namespace diminish
