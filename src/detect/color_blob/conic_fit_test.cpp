#include "detect/color_blob/conic_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

namespace diminish {
namespace {

std::vector<Eigen::Vector2d> points_on(const Ellipse& ellipse, int count, double arc_rad,
                                       double noise_px) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, noise_px);
  const Eigen::Rotation2Dd rotation(ellipse.angle_rad);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < count; ++i) {
    const double angle = arc_rad * i / count;
    const Eigen::Vector2d on_axes(ellipse.half_axes[0] * std::cos(angle),
                                  ellipse.half_axes[1] * std::sin(angle));
    points.emplace_back(
        ellipse.center + rotation * on_axes +
        (noise_px > 0 ? Eigen::Vector2d(noise(random), noise(random)) : Eigen::Vector2d(0, 0)));
  }
  return points;
}

Moments moments_of(const std::vector<Eigen::Vector2d>& points) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : points) box.extend(point);
  Moments moments(box.center(), box.sizes().maxCoeff() / 2);
  for (const Eigen::Vector2d& point : points) moments.add(point);
  return moments;
}

/// With the longer axis first, and its angle from 0 to 180 degrees.
Ellipse canonical(Ellipse ellipse) {
  if (ellipse.half_axes[0] < ellipse.half_axes[1]) {
    std::swap(ellipse.half_axes[0], ellipse.half_axes[1]);
    ellipse.angle_rad += std::numbers::pi / 2;
  }
  ellipse.angle_rad = std::fmod(ellipse.angle_rad + 4 * std::numbers::pi, std::numbers::pi);
  return ellipse;
}

void expect_near(const Ellipse& found, const Ellipse& expected, double tolerance_px) {
  const Ellipse a = canonical(found);
  const Ellipse b = canonical(expected);
  EXPECT_NEAR((a.center - b.center).norm(), 0, tolerance_px);
  EXPECT_NEAR((a.half_axes - b.half_axes).norm(), 0, tolerance_px);
  const double turned = std::remainder(a.angle_rad - b.angle_rad, std::numbers::pi);
  EXPECT_NEAR(turned * (b.half_axes[0] - b.half_axes[1]), 0, 2 * tolerance_px);
}

TEST(ConicFit, AnEllipseIsFoundFromPointsOnIt) {
  for (const double angle : {0.0, 0.4, 1.2, 2.5}) {
    for (const double arc : {2 * std::numbers::pi, std::numbers::pi}) {
      const Ellipse ellipse{{812.3, 401.7}, {120, 75}, angle};
      const auto found = moments_of(points_on(ellipse, 200, arc, 0)).fit_ellipse();
      ASSERT_TRUE(found);
      expect_near(*found, ellipse, 1e-4);
    }
  }
}

/// What the fit makes small: the sum of the squares of a x^2 + b x y + c y^2 + d x + e y + f,
/// scaled so that 4 a c - b^2 = 1.
double algebraic_cost(const Ellipse& ellipse, const std::vector<Eigen::Vector2d>& points) {
  Eigen::Matrix2d form = Eigen::Matrix2d::Zero();
  form.diagonal() = ellipse.half_axes.array().square().inverse();
  const Eigen::Rotation2Dd rotation(ellipse.angle_rad);
  form = rotation * form * rotation.inverse();
  const double scale = 1 / (2 * std::sqrt(form.determinant()));
  double cost = 0;
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d from_center = point - ellipse.center;
    cost += std::pow(scale * (from_center.dot(form * from_center) - 1), 2);
  }
  return cost;
}

/// OpenCV shifts points when its system is nearly singular, so that its ellipse is near the best
/// one.
TEST(ConicFit, AmongNoiseItIsNearOpenCvsAndNotWorse) {
  for (const double angle : {0.1, 0.9, 1.6, 2.9}) {
    const Ellipse ellipse{{230.5, 140.2}, {60, 41}, angle};
    const auto points = points_on(ellipse, 300, 5, 1);
    std::vector<cv::Point2f> peers;
    for (const Eigen::Vector2d& point : points) {
      peers.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()));
    }
    const cv::RotatedRect box = cv::fitEllipseDirect(peers);
    const Ellipse peer{{box.center.x, box.center.y},
                       {box.size.width / 2, box.size.height / 2},
                       box.angle * std::numbers::pi / 180};
    const auto found = moments_of(points).fit_ellipse();
    ASSERT_TRUE(found);
    expect_near(*found, peer, 0.15);
    const double cost = algebraic_cost(*found, points);
    EXPECT_LE(cost, algebraic_cost(peer, points));
    // The least there is: any other ellipse costs more.
    for (int parameter = 0; parameter < 5; ++parameter) {
      for (const double step : {-0.01, 0.01}) {
        Ellipse other = *found;
        if (parameter < 2)
          other.center[parameter] += step;
        else if (parameter < 4)
          other.half_axes[parameter - 2] += step;
        else
          other.angle_rad += step / 50;
        EXPECT_GT(algebraic_cost(other, points), cost);
      }
    }
  }
}

TEST(ConicFit, ACircleIsFoundFromAnArc) {
  const Ellipse circle{{-40, 300}, {90, 90}, 0};
  const auto found = moments_of(points_on(circle, 60, 1.2, 0)).fit_circle();
  ASSERT_TRUE(found);
  expect_near(*found, circle, 1e-6);
}

TEST(ConicFit, PointsOnALineDetermineNothing) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 20; ++i) points.emplace_back(10, i);
  EXPECT_FALSE(moments_of(points).fit_ellipse());
  EXPECT_FALSE(moments_of(points).fit_circle());
}

}  // namespace
}  // namespace diminish
