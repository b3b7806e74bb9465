#include "depth/color_places.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <random>
#include <vector>

#include "analytic_scene.h"

namespace diminish {
namespace {

// Through every lens, on every instruction set, to the bit: a place or none.
TEST(ColorPlaces, OfSeveralPixelsAreThoseOfEach) {
  for (const LensModel model : testing::lens_models) {
    SCOPED_TRACE(name_of(model));
    const RgbdCamera camera =
        testing::AnalyticFrame({}, {Eigen::Vector3d(-0.45, 0.3, 0.9)}, model).rig.rgbd[0];
    const ColorPlaces places(camera);
    std::mt19937 random(2);
    std::uniform_real_distribution<float> ray(-1.2F, 1.2F);
    std::uniform_real_distribution<float> depth(-0.2F, 4);
    constexpr int most = 500;
    std::vector<float> ray_x(most + 16), ray_y(most + 16), depth_m(most + 16);
    for (std::size_t i = 0; i < most; ++i) {
      ray_x[i] = ray(random);
      ray_y[i] = ray(random);
      depth_m[i] = depth(random);
    }
    for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1) {
      const std::int64_t target = rest & -rest;
      hwy::SetSupportedTargetsForTest(target);
      for (const int count : {0, 1, 9, most}) {
        std::vector<std::int32_t> columns(most + 16), lines(most + 16);
        places.find(ray_x.data(), ray_y.data(), depth_m.data(), count, columns.data(),
                    lines.data());
        int found = 0;
        for (int i = 0; i < count; ++i) {
          const auto k = static_cast<std::size_t>(i);
          const ColorPlaces::Place place = places.at(ray_x[k], ray_y[k], depth_m[k]);
          ASSERT_EQ(columns[k], place.column) << i << ' ' << hwy::TargetName(target);
          ASSERT_EQ(lines[k], place.line) << i << ' ' << hwy::TargetName(target);
          found += place.exists() ? 1 : 0;
        }
        if (count < most) continue;
        EXPECT_GT(found, most / 10);
        EXPECT_LT(found, most * 9 / 10);
      }
    }
    hwy::SetSupportedTargetsForTest(0);
  }
}

// A point straight ahead of the colour sensor is at its principal point.
TEST(ColorPlaces, AreWhereTheColorSensorSeesThePoint) {
  const RgbdCamera camera =
      testing::AnalyticFrame({}, {Eigen::Vector3d(-0.45, 0.3, 0.9)}).rig.rgbd[0];
  const Eigen::Vector3d point = camera.color_from_depth.inverse() * Eigen::Vector3d(0, 0, 1.5);
  const ColorPlaces::Place place = ColorPlaces(camera).at(static_cast<float>(point.x() / point.z()),
                                                          static_cast<float>(point.y() / point.z()),
                                                          static_cast<float>(point.z()));
  EXPECT_NEAR(place.column, camera.color.cx, 1);
  EXPECT_NEAR(place.line, camera.color.cy, 1);
}

}  // namespace
}  // namespace diminish
