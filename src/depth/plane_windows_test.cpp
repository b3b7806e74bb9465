#include "depth/plane_windows.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "diminish/image.h"
#include "stepped_surface.h"

namespace diminish {
namespace {

using plane_windows::reach;

constexpr float depth_unit_m = 0.001F;
constexpr int surface_width = 61;
constexpr int surface_height = 30;

/// Slanted surfaces with steps between them, noise and holes.
Image<std::uint16_t> room() {
  Image<std::uint16_t> depth(surface_width, surface_height);
  std::mt19937 random(7);
  std::normal_distribution<float> jitter(0, 4);
  for (int y = 0; y < surface_height; ++y) {
    for (int x = 0; x < surface_width; ++x) {
      const float z = testing::stepped_surface(x, y);
      depth(x, y) =
          random() % 67 == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(z + jitter(random));
    }
  }
  return depth;
}

struct Plane {
  double depth, slope_x, slope_y, variance;
};
/// By Eigen's decomposition.
Plane fitted(const Image<std::uint16_t>& depth, int x, int y) {
  constexpr int count = plane_windows::side * plane_windows::side;
  Eigen::Matrix<double, count, 3> places;
  Eigen::Matrix<double, count, 1> depths;
  int i = 0;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx, ++i) {
      places.row(i) = Eigen::RowVector3d(1, dx, dy);
      depths[i] = depth(x + dx, y + dy);
    }
  }
  const Eigen::Vector3d plane = places.colPivHouseholderQr().solve(depths);
  const double variance = (depths - places * plane).squaredNorm() / (count - 3) + 1. / 12;
  const double usual = DepthNoise().at(static_cast<float>(plane[0]) * depth_unit_m) / depth_unit_m;
  return {plane[0], plane[1], plane[2], variance / (usual * usual)};
}

/// Of each window in the image.
struct AllPlanes {
  explicit AllPlanes(const Image<std::uint16_t>& depth) {
    for (Image<float>* image : {&z, &slope_x, &slope_y, &variance}) {
      image->resize(surface_width, surface_height, 0.F);
    }
    std::vector<double> scratch(3 * std::size_t{surface_width});
    for (int y = reach; y < surface_height - reach; ++y) {
      plane_windows::fit(
          {depth.row(y) + reach, surface_width, surface_width - 2 * reach, depth_unit_m, {}},
          row(y), scratch.data());
    }
  }
  plane_windows::Planes row(int y) {
    return {z.row(y) + reach, slope_x.row(y) + reach, slope_y.row(y) + reach,
            variance.row(y) + reach};
  }

  Image<float> z, slope_x, slope_y, variance;
};

TEST(PlaneWindows, PlanesAreThoseOfAPeer) {
  const Image<std::uint16_t> depth = room();
  const AllPlanes planes(depth);
  for (int y = reach; y < surface_height - reach; ++y) {
    for (int x = reach; x < surface_width - reach; ++x) {
      const Plane plane = fitted(depth, x, y);
      ASSERT_NEAR(planes.z(x, y), plane.depth, 1e-3) << x << ' ' << y;
      ASSERT_NEAR(planes.slope_x(x, y), plane.slope_x, 1e-4) << x << ' ' << y;
      ASSERT_NEAR(planes.slope_y(x, y), plane.slope_y, 1e-4) << x << ' ' << y;
      ASSERT_NEAR(planes.variance(x, y), plane.variance, 1e-5 * plane.variance) << x << ' ' << y;
    }
  }
}

// Every window asks its pixels one by one.
TEST(PlaneWindows, MeansAreThoseOfThePlainVersion) {
  const Image<std::uint16_t> depth = room();
  AllPlanes planes(depth);
  constexpr float half_variance = 0.3F;
  Image<double> weights(surface_width, surface_height, 0.);
  Image<double> depths(surface_width, surface_height, 0.);
  for (int y = reach; y < surface_height - reach; ++y) {
    for (int x = reach; x < surface_width - reach; ++x) {
      const double weight = 1 / (1 + std::pow(planes.variance(x, y) / half_variance, 4));
      for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          weights(x + dx, y + dy) += weight;
          const double there = double{planes.z(x, y)} + dx * double{planes.slope_x(x, y)} +
                               dy * double{planes.slope_y(x, y)};
          depths(x + dx, y + dy) += weight * there;
        }
      }
    }
  }
  Image<float> weight(surface_width, surface_height);
  Image<float> weighted(surface_width, surface_height);
  Image<float> slope(surface_width, surface_height);
  const auto sums = [&](int y) {
    return plane_windows::Sums{weight.row(y), weighted.row(y), slope.row(y)};
  };
  std::vector<float> scratch(4 * std::size_t{surface_width + 2 * reach});
  for (int y = reach; y < surface_height - reach; ++y) {
    plane_windows::add_up({planes.row(y), reach, surface_width - 2 * reach}, half_variance,
                          surface_width, sums(y), scratch.data());
  }
  int changed = 0;
  Image<std::uint16_t> result = depth;
  for (int y = 0; y < surface_height; ++y) {
    plane_windows::Around around{};
    const int first = std::max(y - reach, reach);
    around.first = first - y;
    for (int row = first; row <= y + reach && row < surface_height - reach; ++row) {
      around.rows[static_cast<std::size_t>(around.count++)] = sums(row);
    }
    plane_windows::mix(around, surface_width, result.row(y));
    for (int x = 0; x < surface_width; ++x) {
      const double own = depth(x, y);
      const double mean = (depths(x, y) + plane_windows::own_weight * own) /
                          (weights(x, y) + plane_windows::own_weight);
      ASSERT_NEAR(result(x, y), own == 0 ? 0 : mean, 0.52) << x << ' ' << y;
      changed += result(x, y) != depth(x, y) ? 1 : 0;
    }
  }
  EXPECT_GT(changed, 1000);
}

}  // namespace
}  // namespace diminish
