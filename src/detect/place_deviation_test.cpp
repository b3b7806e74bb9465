#include "detect/place_deviation.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <random>

#include "pose/marker_pose.h"

namespace diminish {
namespace {

constexpr double size_m = 0.12;
constexpr double noise_px = 0.1;
const Lens lens({1280, 1024, 1131, 1130, 645, 508, {-0.11, 0.09, 0, 0, 0}});

RigidTransform marker_at(double lean, double distance_m) {
  RigidTransform pose;
  pose.rotation =
      Eigen::AngleAxisd(lean, Eigen::Vector3d(0.9, 0.4, 0.1).normalized()).toRotationMatrix() *
      Eigen::Vector3d(1, -1, -1).asDiagonal();
  pose.translation = {0.1, -0.05, distance_m};
  return pose;
}

/// The largest root-mean-square movement of a point along any direction, when the marker's corners
/// are seen with noise, its pose estimated from them, and the point projected.
double measured_px(const RigidTransform& truth, const std::vector<Eigen::Vector3d>& points_m) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, noise_px);
  std::vector<Eigen::Matrix2d> sums(points_m.size(), Eigen::Matrix2d::Zero());
  constexpr int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    std::array<Eigen::Vector2d, 4> corners;
    const auto exact = marker_corners(size_m);
    for (std::size_t i = 0; i < 4; ++i) {
      corners[i] = *lens.project(truth * exact[i]) + Eigen::Vector2d(noise(random), noise(random));
    }
    const auto pose = estimate_marker_pose(corners, size_m, lens);
    for (std::size_t i = 0; i < points_m.size(); ++i) {
      const Eigen::Vector2d off = *lens.project(pose->camera_from_marker * points_m[i]) -
                                  *lens.project(truth * points_m[i]);
      sums[i] += off * off.transpose() / trials;
    }
  }
  double most = 0;
  for (const Eigen::Matrix2d& sum : sums) {
    most = std::max(most, sum.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
  }
  return std::sqrt(most);
}

// Against trials with noise, where the marker leans enough for its pose to be unique.
TEST(PlaceDeviation, IsWhatNoiseOnTheCornersMakesOfIt) {
  for (const double lean : {0.6, 0.9}) {
    for (const double distance_m : {0.8, 1.6}) {
      for (const Eigen::Vector3d& far_point :
           {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, 0.2, 0), Eigen::Vector3d(0, 0, 0.3)}) {
        const std::vector<Eigen::Vector3d> points = {Eigen::Vector3d(0.02, 0.01, 0), far_point};
        const RigidTransform pose = marker_at(lean, distance_m);
        const double expected = measured_px(pose, points);
        EXPECT_NEAR(place_deviation_px(pose, size_m, lens, noise_px, points), expected,
                    0.2 * expected)
            << lean << ' ' << distance_m << ' ' << far_point.transpose();
      }
    }
  }
}

TEST(PlaceDeviation, GrowsWithTheArmAndAsTheMarkerShrinks) {
  const RigidTransform pose = marker_at(0.6, 1);
  const auto at = [&](double arm_m, double marker_m) {
    return place_deviation_px(pose, marker_m, lens, noise_px, {{0, 0, arm_m}});
  };
  EXPECT_GT(at(0.4, size_m), 1.5 * at(0.2, size_m));
  EXPECT_GT(at(0.2, size_m / 2), 1.9 * at(0.2, size_m));
  EXPECT_LT(at(0, size_m), noise_px);
}

}  // namespace
}  // namespace diminish
