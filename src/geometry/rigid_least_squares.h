#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "diminish/rigid_transform.h"
#include "geometry/rotation.h"
#include "geometry/symmetric_solver.h"

namespace diminish {

// Least squares in the six degrees of freedom of a rigid transform.

/// The unknowns: a small motion of points after the transform. First three: a rotation about the
/// origin of their frame (axis times angle, radians). Last three: a shift (metres).
using Motion = Eigen::Matrix<double, 6, 1>;

inline RigidTransform to_transform(const Motion& motion) {
  return {rotation_by(motion.head<3>()), motion.tail<3>()};
}

/// The derivative of a point p by a rotation about the frame's origin: minus the matrix of the
/// cross product with p.
inline Eigen::Matrix3d derivative_by_rotation(const Eigen::Vector3d& p) {
  Eigen::Matrix3d by_rotation;
  by_rotation << 0, p.z(), -p.y(),  //
      -p.z(), 0, p.x(),             //
      p.y(), -p.x(), 0;
  return by_rotation;
}

/// The derivative of a point by a small motion.
inline Eigen::Matrix<double, 3, 6> derivative_by_motion(const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 3, 6> by_motion;
  by_motion << derivative_by_rotation(p), Eigen::Matrix3d::Identity();
  return by_motion;
}

/// squares * step = products. The solution is the step to the least sum of squares.
template <class Scalar>
struct NormalEquations {
  using Vector = Eigen::Matrix<Scalar, 6, 1>;
  using Matrix = Eigen::Matrix<Scalar, 6, 6>;

  Matrix squares = Matrix::Zero();
  Vector products = Vector::Zero();

  /// Adds `rows` errors (measured minus predicted) and the derivatives of the predictions by the
  /// unknowns.
  template <int rows>
  void add(const Eigen::Matrix<Scalar, rows, 6>& jacobian,
           const Eigen::Matrix<Scalar, rows, 1>& errors) {
    squares += jacobian.transpose() * jacobian;
    products += jacobian.transpose() * errors;
  }
  void add(const NormalEquations& others, Scalar weight) {
    squares += weight * others.squares;
    products += weight * others.products;
  }

  /// The equations for other unknowns: these unknowns are `from_others` times the others.
  NormalEquations in_terms_of(const Matrix& from_others) const {
    return {from_others.transpose() * squares * from_others, from_others.transpose() * products};
  }

  /// damping: enlarges the diagonal by this share of it, for a shorter step (Marquardt 1963).
  Vector solve(Scalar damping = 0) const {
    Matrix damped = squares;
    damped.diagonal() *= 1 + damping;
    return solve_symmetric(damped, products);
  }
};

/// Levenberg-Marquardt (Marquardt 1963): takes steps that lower the cost, until the gain is tiny or
/// `most_steps` steps have been tried. Returns the remaining cost. Leaves `state` unchanged if its
/// cost is not finite.
///
/// linearise(state): returns something whose solve(damping) is the step, such as
/// NormalEquations<double>. It may change the cost function, as robust weights do.
/// move(state, step): returns the state after the step.
/// cost(state): returns NaN for an impossible state.
template <class State, class Linearise, class Move, class Cost>
double levenberg_marquardt(State& state, double damping, int most_steps, const Linearise& linearise,
                           const Move& move, const Cost& cost) {
  constexpr double factor = 10;
  constexpr double most_damping = 1e6;
  constexpr double least_damping = 1e-16;  // 1 + this is 1
  constexpr double least_gain = 1e-12;
  auto linear = linearise(state);
  double own_cost = cost(state);
  for (int step = 0; step < most_steps && std::isfinite(own_cost); ++step) {
    State next = move(state, linear.solve(damping));
    const double next_cost = cost(next);
    if (!(next_cost < own_cost)) {
      damping *= factor;
      if (damping > most_damping) break;
      continue;
    }
    const bool is_last = own_cost - next_cost <= least_gain * own_cost;
    state = std::move(next);
    own_cost = next_cost;
    if (is_last) break;
    damping = std::max(damping / factor, least_damping);
    linear = linearise(state);
    own_cost = cost(state);
  }
  return own_cost;
}

}  // namespace diminish
