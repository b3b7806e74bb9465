#include "detect/silhouette/silhouette.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace diminish {
namespace {

using Triangles = std::vector<std::array<int, 3>>;
using Points = std::vector<Eigen::Vector3d>;

const Intrinsics barrel{160, 128, 110, 112, 82.3, 60.7, {-0.25, 0.07, 0.002, -0.001, 0}};
const Intrinsics pincushion{160, 120, 120, 120, 78.5, 61.2, {0.2, -0.25, -0.001, 0.002, 0.08}};
/// Folds back at a radius of 0.91, a little outside the picture.
const Intrinsics folding{160, 120, 168, 168, 80, 60, {-0.4, 0, 0, 0, 0}};

const Intrinsics rational{160,
                          120,
                          100,
                          101,
                          80,
                          60,
                          {0.3, 0.1, 0.001, -0.002, 0.02, 0.55, 0.12, 0.03},
                          LensModel::rational};
/// Of 73 degrees at the corners.
const Intrinsics fisheye{
    160, 120, 80, 79, 79.1, 60.4, {0.02, -0.01, 0.003, -0.001}, LensModel::fisheye};

/// Whether the ray (x, y, 1) meets the triangle at least 1 cm in front of the camera's plane
/// (Moeller & Trumbore 1997).
bool ray_meets_triangle(const Eigen::Vector2d& ray, const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  Eigen::Matrix3d system;
  system << a - b, a - c, ray.homogeneous();
  if (std::abs(system.determinant()) < 1e-15) return false;
  const Eigen::Vector3d solution = system.partialPivLu().solve(a);
  return solution[0] >= 0 && solution[1] >= 0 && solution[0] + solution[1] <= 1 &&
         solution[2] >= 0.01;
}

bool ray_meets(const Eigen::Vector2d& ray, const Points& points, const Triangles& triangles) {
  return std::any_of(triangles.begin(), triangles.end(), [&](const auto& triangle) {
    return ray_meets_triangle(ray, points[triangle[0]], points[triangle[1]], points[triangle[2]]);
  });
}

/// All triangles between any three of the points: a ray that meets their convex hull meets one.
Triangles all_triples(int count) {
  Triangles triples;
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      for (int c = b + 1; c < count; ++c) triples.push_back({a, b, c});
    }
  }
  return triples;
}

/// Compares a mask with casting a ray through every pixel; only pixels within 0.1 px of the outline
/// may differ. Returns the number of pixels that the rays hit.
int expect_as_ray_cast(const Mask& mask, const Lens& lens, const Points& points,
                       const Triangles& triangles) {
  const auto hit = [&](double x, double y) {
    return ray_meets(lens.undistort({x, y}), points, triangles);
  };
  const auto near_outline = [&](int x, int y, bool centre) {
    for (const double radius : {0.01, 0.03, 0.06, 0.1}) {
      for (int step = 0; step < 32; ++step) {
        const double angle = step * std::numbers::pi / 16;
        if (hit(x + radius * std::cos(angle), y + radius * std::sin(angle)) != centre) return true;
      }
    }
    return false;
  };
  int hits = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      const bool expected = hit(x, y);
      hits += expected;
      if ((mask(x, y) == 255) != expected && !near_outline(x, y, expected)) {
        ADD_FAILURE() << "pixel " << x << ", " << y << ": expected " << expected;
        return hits;
      }
    }
  }
  return hits;
}

Points random_points(std::mt19937& random, int count, const Eigen::Vector3d& centre, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  Points points;
  for (int i = 0; i < count; ++i) {
    points.push_back(centre + Eigen::Vector3d(uniform(random), uniform(random), uniform(random)));
  }
  return points;
}

struct Shape {
  const char* name;
  Eigen::Vector3d centre;
  double size_m;
};
const Shape shapes[] = {{"inside", {0, 0, 2}, 0.7},      {"partly outside", {0.9, 0.7, 1.5}, 0.8},
                        {"behind", {0.1, 0.1, 0.3}, 1},  {"around the camera", {0, 0, 0}, 1.5},
                        {"tiny", {0.2, -0.1, 1}, 0.005}, {"covers all", {0, 0, 4}, 30}};

TEST(Silhouette, ConvexHullIsWhatRaysMeet) {
  std::mt19937 random(1);
  for (const Intrinsics& intrinsics : {barrel, pincushion, folding, rational, fisheye}) {
    const Lens lens(intrinsics);
    for (const Shape& shape : shapes) {
      SCOPED_TRACE(shape.name);
      int hits = 0;
      for (int repeat = 0; repeat < 4; ++repeat) {
        const Points points = random_points(random, 4 + repeat, shape.centre, shape.size_m);
        Mask mask(intrinsics.width, intrinsics.height);
        const bool drawn = SilhouetteDrawer(lens).fill_convex_hull(points, mask);
        EXPECT_EQ(drawn, count_nonzero(mask, mask.bounds()) > 0);
        hits += expect_as_ray_cast(mask, lens, points, all_triples(4 + repeat));
      }
      EXPECT_GT(hits + (shape.size_m < 0.01), 0);
    }
  }
}

TEST(Silhouette, TrianglesAreWhatRaysMeet) {
  std::mt19937 random(2);
  for (const Intrinsics& intrinsics : {barrel, pincushion, folding, rational, fisheye}) {
    const Lens lens(intrinsics);
    for (const Shape& shape : shapes) {
      SCOPED_TRACE(shape.name);
      for (int repeat = 0; repeat < 4; ++repeat) {
        const Points points = random_points(random, 7, shape.centre, shape.size_m);
        const Triangles triangles = {{0, 1, 2}, {2, 3, 4}, {4, 5, 6}};
        Mask mask(intrinsics.width, intrinsics.height);
        const bool drawn = SilhouetteDrawer(lens).fill_triangles(points, triangles, mask);
        EXPECT_EQ(drawn, count_nonzero(mask, mask.bounds()) > 0);
        expect_as_ray_cast(mask, lens, points, triangles);
      }
    }
  }
}

TEST(Silhouette, NeighbouringTrianglesLeaveNoGap) {
  const Lens lens(barrel);
  constexpr int cells = 20;
  Points points;
  Triangles triangles;
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) points.emplace_back(0.2 * x - 2, 0.2 * y - 2, 1.7);
  }
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      const int corner = y * (cells + 1) + x;
      triangles.push_back({corner, corner + 1, corner + cells + 1});
      triangles.push_back({corner + cells + 2, corner + cells + 1, corner + 1});
    }
  }
  Mask mask(barrel.width, barrel.height);
  EXPECT_TRUE(SilhouetteDrawer(lens).fill_triangles(points, triangles, mask));
  EXPECT_EQ(mask, Mask(barrel.width, barrel.height, 255));
}

TEST(Silhouette, EdgeOnAndOutsideShapesSetNothing) {
  const Lens lens(pincushion);
  Mask mask(pincushion.width, pincushion.height);
  const Eigen::Vector3d toward(0.113, 0.047, 1);  // a plane through the camera's centre
  const Points edge_on = {toward, 2 * toward, toward + Eigen::Vector3d(0.2, 0.1, 0),
                          2 * toward + Eigen::Vector3d(0.2, 0.1, 0)};
  EXPECT_FALSE(SilhouetteDrawer(lens).fill_convex_hull(edge_on, mask));
  EXPECT_FALSE(SilhouetteDrawer(lens).fill_triangles(edge_on, {{0, 1, 2}, {1, 2, 3}}, mask));
  const Points behind = {{0, 0, -1}, {1, 0, -1}, {0, 1, -1}, {1, 1, -2}};
  EXPECT_FALSE(SilhouetteDrawer(lens).fill_convex_hull(behind, mask));
  const Points beside = {{50, 0, 1}, {51, 0, 1}, {50, 1, 1}, {51, 1, 2}};
  EXPECT_FALSE(SilhouetteDrawer(lens).fill_convex_hull(beside, mask));
  EXPECT_FALSE(SilhouetteDrawer(lens).fill_convex_hull({}, mask));
  EXPECT_EQ(mask, Mask(pincushion.width, pincushion.height));
}

TEST(Silhouette, LeavesOtherPixelsAlone) {
  const Lens lens(barrel);
  Mask mask(barrel.width, barrel.height, 7);
  SilhouetteDrawer(lens).fill_convex_hull({{0, 0, 2}, {0.1, 0, 2}, {0, 0.1, 2}, {0.1, 0.1, 2}},
                                          mask);
  EXPECT_EQ(mask(10, 10), 7);
  EXPECT_EQ(mask(85, 63), 255);
}

}  // namespace
}  // namespace diminish
