#include "setup/calibrate/fixed_pose_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/robust.h"
#include "geometry/rotation.h"

namespace diminish {
namespace {

constexpr std::size_t most_sightings = 400;
/// Pixels; beyond this a corner is simply wrong.
constexpr double worst_error_px = 20;

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix26 = Eigen::Matrix<double, 2, 6>;

/// The undistorted corner, as an ideal camera of the same focal length sees it.
Eigen::Vector2d ideal_pixel(const Lens& lens, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d ray = lens.undistort(pixel);
  return {lens.intrinsics().fx * ray.x(), lens.intrinsics().fy * ray.y()};
}

Eigen::Vector2d project(const Lens& lens, const Eigen::Vector3d& p) {
  return {lens.intrinsics().fx * p.x() / p.z(), lens.intrinsics().fy * p.y() / p.z()};
}

Eigen::Matrix<double, 2, 3> projection_derivative(const Lens& lens, const Eigen::Vector3d& p) {
  const double fx = lens.intrinsics().fx;
  const double fy = lens.intrinsics().fy;
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << fx / p.z(), 0, -fx * p.x() / (p.z() * p.z()),  //
      0, fy / p.z(), -fy * p.y() / (p.z() * p.z());
  return by_point;
}

/// Derivatives of p by a rotation about the frame's origin and a shift, both applied after the
/// transform that made p.
Eigen::Matrix<double, 3, 6> motion_derivative(const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 3, 6> by_motion;
  by_motion << 0, p.z(), -p.y(), 1, 0, 0,  //
      -p.z(), 0, p.x(), 0, 1, 0,           //
      p.y(), -p.x(), 0, 0, 0, 1;
  return by_motion;
}

RigidTransform motion(const Vector6d& change) {
  return {rotation_by(change.head<3>()), change.tail<3>()};
}

}  // namespace

FixedPoseFit::FixedPoseFit(const Lens& first, const Lens& second)
    : first_(first), second_(second) {}

void FixedPoseFit::add(const TargetView& in_first, const TargetView& in_second) {
  if (sightings_.size() == most_sightings) return;
  Sighting sighting{in_first, in_second, {}, {}};
  if (in_first.points_m != in_second.points_m) {
    // Each camera may have seen different corners of a board.
    sighting.first.points_m.clear();
    sighting.first.pixels.clear();
    sighting.second.points_m.clear();
    sighting.second.pixels.clear();
    for (std::size_t i = 0; i < in_first.points_m.size(); ++i) {
      const auto same =
          std::find(in_second.points_m.begin(), in_second.points_m.end(), in_first.points_m[i]);
      if (same == in_second.points_m.end()) continue;
      sighting.first.points_m.push_back(*same);
      sighting.first.pixels.push_back(in_first.pixels[i]);
      sighting.second.points_m.push_back(*same);
      sighting.second.pixels.push_back(
          in_second.pixels[static_cast<std::size_t>(same - in_second.points_m.begin())]);
    }
  }
  if (sighting.first.points_m.size() < 4) return;
  for (std::size_t i = 0; i < sighting.first.pixels.size(); ++i) {
    sighting.first_px.push_back(ideal_pixel(first_, sighting.first.pixels[i]));
    sighting.second_px.push_back(ideal_pixel(second_, sighting.second.pixels[i]));
  }
  sightings_.push_back(std::move(sighting));
}

/// The distance between the target as the second camera sees it and as the first one does.
double FixedPoseFit::transfer_error_px(const Sighting& sighting,
                                       const RigidTransform& first_from_second,
                                       RigidTransform* second_from_target) const {
  double best = std::numeric_limits<double>::infinity();
  for (const bool other : {false, true}) {
    if (other && !sighting.second.doubtful) break;
    const RigidTransform& pose =
        other ? sighting.second.alternative : sighting.second.camera_from_target;
    double squares = 0;
    for (std::size_t i = 0; i < sighting.first_px.size(); ++i) {
      const Eigen::Vector3d p = first_from_second * (pose * sighting.first.points_m[i]);
      squares += p.z() > 0 ? (project(first_, p) - sighting.first_px[i]).squaredNorm()
                           : worst_error_px * worst_error_px;
    }
    const double error = std::sqrt(squares / static_cast<double>(sighting.first_px.size()));
    if (error < best) {
      best = error;
      if (second_from_target) *second_from_target = pose;
    }
  }
  return best;
}

/// Of the transforms from single sightings, the one that most others agree with.
RigidTransform FixedPoseFit::start() const {
  constexpr std::size_t most_candidates = 60;
  RigidTransform best;
  double best_cost = std::numeric_limits<double>::infinity();
  const std::size_t step = (sightings_.size() + most_candidates - 1) / most_candidates;
  for (std::size_t i = 0; i < sightings_.size(); i += step) {
    const Sighting& s = sightings_[i];
    for (const bool first_other : {false, true}) {
      for (const bool second_other : {false, true}) {
        if ((first_other && !s.first.doubtful) || (second_other && !s.second.doubtful)) continue;
        const RigidTransform candidate =
            (first_other ? s.first.alternative : s.first.camera_from_target) *
            (second_other ? s.second.alternative : s.second.camera_from_target).inverse();
        double cost = 0;
        for (const Sighting& other : sightings_) {
          cost += std::min(transfer_error_px(other, candidate, nullptr), worst_error_px);
        }
        if (cost < best_cost) {
          best_cost = cost;
          best = candidate;
        }
      }
    }
  }
  return best;
}

std::optional<FixedPoseFit::Result> FixedPoseFit::solve() const {
  if (sightings_.empty()) return std::nullopt;
  RigidTransform first_from_second = start();
  std::vector<RigidTransform> second_from_target(sightings_.size());
  for (std::size_t s = 0; s < sightings_.size(); ++s) {
    transfer_error_px(sightings_[s], first_from_second, &second_from_target[s]);
  }
  const std::size_t count = sightings_.size();
  std::vector<double> errors(count);
  std::vector<double> weights(count, 1);
  const auto evaluate = [&](const RigidTransform& transform,
                            const std::vector<RigidTransform>& targets) {
    double cost = 0;
    for (std::size_t s = 0; s < count; ++s) {
      const Sighting& sighting = sightings_[s];
      double squares = 0;
      for (std::size_t i = 0; i < sighting.first_px.size(); ++i) {
        const Eigen::Vector3d in_second = targets[s] * sighting.first.points_m[i];
        squares += (project(second_, in_second) - sighting.second_px[i]).squaredNorm() +
                   (project(first_, transform * in_second) - sighting.first_px[i]).squaredNorm();
      }
      errors[s] = std::sqrt(squares / static_cast<double>(2 * sighting.first_px.size()));
      cost += weights[s] * squares;
    }
    return cost;
  };

  Matrix6d information = Matrix6d::Zero();
  double damping = 1e-4;
  constexpr int steps = 60;
  for (int step = 0; step < steps; ++step) {
    evaluate(first_from_second, second_from_target);
    std::vector<double> sorted = errors;
    const double scale = std::max(1.5 * median(sorted), 0.05);
    for (std::size_t s = 0; s < count; ++s) {
      weights[s] = static_cast<double>(
          tukey_weight(static_cast<float>(errors[s]), static_cast<float>(4.7 * scale)));
    }
    const double cost = evaluate(first_from_second, second_from_target);
    // Each target's pose has its own block in the normal equations, which is eliminated (Schur
    // complement).
    information.setZero();
    Vector6d gradient = Vector6d::Zero();
    std::vector<Matrix6d> blocks(count);
    std::vector<Matrix6d> mixed(count);
    std::vector<Vector6d> block_gradients(count);
    for (std::size_t s = 0; s < count; ++s) {
      Matrix6d block = Matrix6d::Zero();
      Matrix6d cross = Matrix6d::Zero();
      Matrix6d own = Matrix6d::Zero();
      Vector6d block_gradient = Vector6d::Zero();
      Vector6d own_gradient = Vector6d::Zero();
      const Sighting& sighting = sightings_[s];
      for (std::size_t i = 0; i < sighting.first_px.size(); ++i) {
        const Eigen::Vector3d in_second = second_from_target[s] * sighting.first.points_m[i];
        const Eigen::Vector3d in_first = first_from_second * in_second;
        const Eigen::Matrix<double, 3, 6> by_target = motion_derivative(in_second);
        const Matrix26 second_by_target = projection_derivative(second_, in_second) * by_target;
        const Eigen::Matrix<double, 2, 3> by_first = projection_derivative(first_, in_first);
        const Matrix26 first_by_target = by_first * first_from_second.rotation * by_target;
        const Matrix26 first_by_transform = by_first * motion_derivative(in_first);
        const Eigen::Vector2d second_error = sighting.second_px[i] - project(second_, in_second);
        const Eigen::Vector2d first_error = sighting.first_px[i] - project(first_, in_first);
        block += second_by_target.transpose() * second_by_target +
                 first_by_target.transpose() * first_by_target;
        cross += first_by_transform.transpose() * first_by_target;
        own += first_by_transform.transpose() * first_by_transform;
        block_gradient +=
            second_by_target.transpose() * second_error + first_by_target.transpose() * first_error;
        own_gradient += first_by_transform.transpose() * first_error;
      }
      Matrix6d damped = block;
      damped.diagonal() *= 1 + damping;
      blocks[s] = damped.ldlt().solve(Matrix6d::Identity());
      mixed[s] = cross;
      block_gradients[s] = block_gradient;
      information += weights[s] * (own - cross * blocks[s] * cross.transpose());
      gradient += weights[s] * (own_gradient - cross * blocks[s] * block_gradient);
    }
    Matrix6d damped = information;
    damped.diagonal() *= 1 + damping;
    const Vector6d change = damped.ldlt().solve(gradient);
    const RigidTransform next = motion(change) * first_from_second;
    std::vector<RigidTransform> next_targets(count);
    for (std::size_t s = 0; s < count; ++s) {
      const Vector6d target_change =
          blocks[s] * (block_gradients[s] - mixed[s].transpose() * change);
      next_targets[s] = motion(target_change) * second_from_target[s];
    }
    if (!(evaluate(next, next_targets) < cost)) {
      damping *= 10;
      if (damping > 1e6) break;
      continue;
    }
    first_from_second = next;
    second_from_target = std::move(next_targets);
    damping = std::max(damping / 10, 1e-12);
    if (change.norm() < 1e-10) break;
  }
  evaluate(first_from_second, second_from_target);

  Result result;
  result.first_from_second = first_from_second;
  double squares = 0;
  double least_squares = 0;
  double corners = 0;
  for (std::size_t s = 0; s < count; ++s) {
    if (weights[s] < 0.1) continue;
    ++result.agreeing;
    const auto n = static_cast<double>(sightings_[s].first_px.size());
    squares += 2 * n * errors[s] * errors[s];
    least_squares += n * (sightings_[s].first.error_px * sightings_[s].first.error_px +
                          sightings_[s].second.error_px * sightings_[s].second.error_px);
    corners += 2 * n;
  }
  if (corners == 0) return std::nullopt;
  result.error_px = std::sqrt(squares / corners);
  result.least_error_px = std::sqrt(least_squares / corners);
  // Two coordinates per corner; six unknowns for each target and for the transform.
  const double freedom = std::max(2 * corners - 6 * static_cast<double>(result.agreeing) - 6, 1.0);
  const Matrix6d covariance = information.ldlt().solve(Matrix6d::Identity()) * (squares / freedom);
  result.deviation_deg =
      std::sqrt(std::max(0.0, covariance.diagonal().head<3>().maxCoeff())) * 180 / std::numbers::pi;
  result.deviation_m = std::sqrt(std::max(0.0, covariance.diagonal().tail<3>().maxCoeff()));
  return result;
}

}  // namespace diminish
