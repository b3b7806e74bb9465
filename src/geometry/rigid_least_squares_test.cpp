#include "geometry/rigid_least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "geometry/ideal_camera.h"

namespace diminish {
namespace {

Eigen::Vector3d random_point(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

Motion random_motion(std::mt19937& random, double reach) {
  Motion motion;
  motion << random_point(random, reach), random_point(random, reach);
  return motion;
}

TEST(RigidLeastSquares, DerivativesAreTheNumericOnes) {
  std::mt19937 random(1);
  constexpr double h = 1e-6;
  const Lens lens({640, 480, 700, 650, 320, 240, {}});
  const IdealCamera camera(lens);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d p = random_point(random, 1) + Eigen::Vector3d(0, 0, 2);
    for (int i = 0; i < 6; ++i) {
      const Motion by_motion = h * Motion::Unit(i);
      const Eigen::Vector3d moved =
          (to_transform(by_motion) * p - to_transform(-by_motion) * p) / (2 * h);
      EXPECT_LT((derivative_by_motion(p).col(i) - moved).norm(), 1e-8);
      if (i >= 3) continue;
      EXPECT_LT((derivative_by_rotation(p).col(i) - moved).norm(), 1e-8);
      const Eigen::Vector3d aside = h * Eigen::Vector3d::Unit(i);
      const Eigen::Vector2d by_point =
          (camera.project(p + aside) - camera.project(p - aside)) / (2 * h);
      EXPECT_LT((camera.derivative(p).col(i) - by_point).norm(), 1e-5);
    }
  }
}

TEST(IdealCamera, SeesTheRealCamerasRays) {
  const Lens lens({640, 480, 700, 650, 320, 240, {-0.2, 0.1, 0.001, 0, 0}});
  const IdealCamera camera(lens);
  const Eigen::Vector3d p(0.3, -0.2, 1.5);
  EXPECT_LT((camera.ideal_pixel(lens, *lens.project(p)) - camera.project(p)).norm(), 1e-5);
  EXPECT_LT((camera.ray(camera.project(p)) - p.head<2>() / p.z()).norm(), 1e-12);
}

TEST(NormalEquations, SolveALinearProblemInAnyUnknowns) {
  std::mt19937 random(2);
  const Eigen::Matrix<double, 20, 6> jacobian =
      Eigen::Matrix<double, 20, 6>::NullaryExpr([&] { return random_point(random, 1).x(); });
  const Eigen::Matrix<double, 20, 1> errors =
      Eigen::Matrix<double, 20, 1>::NullaryExpr([&] { return random_point(random, 1).x(); });
  const Motion expected = jacobian.colPivHouseholderQr().solve(errors);
  NormalEquations<double> equations;
  equations.add<20>(jacobian, errors);
  EXPECT_LT((equations.solve() - expected).norm(), 1e-12);
  NormalEquations<double> twice;
  twice.add(equations, 0.5);
  twice.add(equations, 1.5);
  EXPECT_LT((twice.squares - 2 * equations.squares).norm(), 1e-12);
  EXPECT_LT((twice.solve() - expected).norm(), 1e-12);

  Eigen::Matrix<double, 6, 6> from_others = Eigen::Matrix<double, 6, 6>::Identity();
  from_others(4, 1) = 0.7;
  from_others(0, 0) = 3;
  EXPECT_LT((from_others * equations.in_terms_of(from_others).solve() - expected).norm(), 1e-12);

  // A damped step is shorter, and still downhill.
  const Motion damped = equations.solve(1);
  EXPECT_LT(damped.norm(), expected.norm());
  EXPECT_LT((jacobian * damped - errors).norm(), errors.norm());
}

/// Points to points: what Umeyama 1991 solves in closed form.
struct Registration {
  std::vector<Eigen::Vector3d> from, to;

  NormalEquations<double> linearise(const RigidTransform& transform) const {
    NormalEquations<double> equations;
    for (std::size_t i = 0; i < from.size(); ++i) {
      const Eigen::Vector3d p = transform * from[i];
      equations.add<3>(derivative_by_motion(p), to[i] - p);
    }
    return equations;
  }
  double cost(const RigidTransform& transform) const {
    double squares = 0;
    for (std::size_t i = 0; i < from.size(); ++i)
      squares += (transform * from[i] - to[i]).squaredNorm();
    return squares;
  }
  double solve(RigidTransform& transform, int most_steps = 50) const {
    return levenberg_marquardt(
        transform, 1e-3, most_steps, [&](const auto& at) { return linearise(at); },
        [](const auto& at, const Motion& step) { return to_transform(step) * at; },
        [&](const auto& at) { return cost(at); });
  }
};

TEST(LevenbergMarquardt, FindsTheTransformOfTheLeastSquares) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const RigidTransform truth = to_transform(random_motion(random, 1));
    Registration task;
    Eigen::Matrix3Xd from(3, 12), to(3, 12);
    for (int i = 0; i < 12; ++i) {
      task.from.push_back(random_point(random, 1));
      task.to.push_back(truth * task.from.back() + random_point(random, 0.2));
      from.col(i) = task.from.back();
      to.col(i) = task.to.back();
    }
    const Eigen::Matrix4d expected = Eigen::umeyama(from, to, false);
    RigidTransform transform;
    const double cost = task.solve(transform);
    EXPECT_NEAR(cost, task.cost(transform), 1e-12);
    EXPECT_LT((transform.rotation - expected.topLeftCorner<3, 3>()).norm(), 1e-5);
    EXPECT_LT((transform.translation - expected.topRightCorner<3, 1>()).norm(), 1e-5);
  }
}

TEST(LevenbergMarquardt, NeverTakesAStepThatIsNoGain) {
  std::mt19937 random(4);
  Registration task;
  for (int i = 0; i < 6; ++i) {
    task.from.push_back(random_point(random, 1));
    task.to.push_back(to_transform(Motion::Constant(0.5)) * task.from.back());
  }
  double before = task.cost({});
  for (int most_steps = 1; most_steps < 6; ++most_steps) {
    RigidTransform transform;
    const double cost = task.solve(transform, most_steps);
    EXPECT_LE(cost, before);
    before = cost;
  }
  EXPECT_LT(before, 1e-6);
  // A gradient of the wrong sign leads uphill, however short the step.
  RigidTransform transform;
  const double cost = levenberg_marquardt(
      transform, 1e-3, 50,
      [&](const auto& at) {
        NormalEquations<double> equations = task.linearise(at);
        equations.products *= -1;
        return equations;
      },
      [](const auto& at, const Motion& step) { return to_transform(step) * at; },
      [&](const auto& at) { return task.cost(at); });
  EXPECT_EQ(cost, task.cost({}));
  EXPECT_EQ(transform.translation, Eigen::Vector3d(0, 0, 0));
}

TEST(LevenbergMarquardt, LeavesAStateThatHasNoCost) {
  Registration task;
  task.from.emplace_back(0, 0, 1);
  task.to.emplace_back(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  RigidTransform transform;
  EXPECT_TRUE(std::isnan(task.solve(transform)));
  EXPECT_EQ(transform.translation, Eigen::Vector3d(0, 0, 0));
}

}  // namespace
}  // namespace diminish
