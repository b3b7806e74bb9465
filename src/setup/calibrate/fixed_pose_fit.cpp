#include "setup/calibrate/fixed_pose_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/robust.h"
#include "geometry/rigid_least_squares.h"

namespace diminish {
namespace {

constexpr std::size_t most_sightings = 400;
/// Pixels; beyond this a corner is simply wrong.
constexpr double worst_error_px = 20;

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix26 = Eigen::Matrix<double, 2, 6>;

}  // namespace

struct FixedPoseFit::Poses {
  RigidTransform first_from_second;
  std::vector<RigidTransform> second_from_target;  ///< by sighting
};

/// Each target's pose has its own block in the normal equations, which is eliminated (Schur
/// complement).
struct FixedPoseFit::Linearised {
  struct Block {
    NormalEquations<double> transform, target;
    Matrix6d mixed = Matrix6d::Zero();  ///< rows: the transform's unknowns; columns: the target's
    double weight = 0;
  };
  struct Step {
    Motion transform;
    std::vector<Motion> targets;
  };
  std::vector<Block> blocks;  ///< by sighting

  /// The equations of the transform alone. Also returns the inverses of the targets' squares.
  NormalEquations<double> eliminate(double damping, std::vector<Matrix6d>& inverses) const {
    NormalEquations<double> sum;
    inverses.clear();
    for (const Block& block : blocks) {
      Matrix6d damped = block.target.squares;
      damped.diagonal() *= 1 + damping;
      inverses.emplace_back(damped.ldlt().solve(Matrix6d::Identity()));
      const Matrix6d from_target = block.mixed * inverses.back();
      sum.add({block.transform.squares - from_target * block.mixed.transpose(),
               block.transform.products - from_target * block.target.products},
              block.weight);
    }
    return sum;
  }

  Step solve(double damping) const {
    std::vector<Matrix6d> inverses;
    Step step{eliminate(damping, inverses).solve(damping), {}};
    for (std::size_t s = 0; s < blocks.size(); ++s) {
      step.targets.emplace_back(
          inverses[s] * (blocks[s].target.products - blocks[s].mixed.transpose() * step.transform));
    }
    return step;
  }
};

FixedPoseFit::FixedPoseFit(const Lens& first, const Lens& second)
    : first_lens_(first), second_lens_(second), first_(first), second_(second) {}

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
    sighting.first_px.push_back(first_.ideal_pixel(first_lens_, sighting.first.pixels[i]));
    sighting.second_px.push_back(second_.ideal_pixel(second_lens_, sighting.second.pixels[i]));
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
      squares += p.z() > 0 ? (first_.project(p) - sighting.first_px[i]).squaredNorm()
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

double FixedPoseFit::squared_error(const Sighting& sighting,
                                   const RigidTransform& first_from_second,
                                   const RigidTransform& second_from_target) const {
  double squares = 0;
  for (std::size_t i = 0; i < sighting.first_px.size(); ++i) {
    const Eigen::Vector3d in_second = second_from_target * sighting.first.points_m[i];
    squares += (second_.project(in_second) - sighting.second_px[i]).squaredNorm() +
               (first_.project(first_from_second * in_second) - sighting.first_px[i]).squaredNorm();
  }
  return squares;
}

std::vector<double> FixedPoseFit::errors_px(const Poses& poses) const {
  std::vector<double> errors;
  for (std::size_t s = 0; s < sightings_.size(); ++s) {
    const double squares =
        squared_error(sightings_[s], poses.first_from_second, poses.second_from_target[s]);
    errors.push_back(std::sqrt(squares / static_cast<double>(2 * sightings_[s].first_px.size())));
  }
  return errors;
}

std::vector<double> FixedPoseFit::weights(const Poses& poses) const {
  const std::vector<double> errors = errors_px(poses);
  std::vector<double> sorted = errors;
  const double scale = std::max(1.5 * median(sorted), 0.05);
  std::vector<double> result;
  for (const double error : errors) {
    result.push_back(static_cast<double>(
        tukey_weight(static_cast<float>(error), static_cast<float>(4.7 * scale))));
  }
  return result;
}

FixedPoseFit::Linearised FixedPoseFit::linearise(const Poses& poses,
                                                 const std::vector<double>& weights) const {
  Linearised linearised;
  for (std::size_t s = 0; s < sightings_.size(); ++s) {
    const Sighting& sighting = sightings_[s];
    Linearised::Block block;
    block.weight = weights[s];
    for (std::size_t i = 0; i < sighting.first_px.size(); ++i) {
      const Eigen::Vector3d in_second = poses.second_from_target[s] * sighting.first.points_m[i];
      const Eigen::Vector3d in_first = poses.first_from_second * in_second;
      const Eigen::Matrix<double, 3, 6> by_target = derivative_by_motion(in_second);
      const Matrix26 second_by_target = second_.derivative(in_second) * by_target;
      const Eigen::Matrix<double, 2, 3> by_first = first_.derivative(in_first);
      const Matrix26 first_by_target = by_first * poses.first_from_second.rotation * by_target;
      const Matrix26 first_by_transform = by_first * derivative_by_motion(in_first);
      const Eigen::Vector2d second_error = sighting.second_px[i] - second_.project(in_second);
      const Eigen::Vector2d first_error = sighting.first_px[i] - first_.project(in_first);
      block.target.add(second_by_target, second_error);
      block.target.add(first_by_target, first_error);
      block.transform.add(first_by_transform, first_error);
      block.mixed += first_by_transform.transpose() * first_by_target;
    }
    linearised.blocks.push_back(block);
  }
  return linearised;
}

std::optional<FixedPoseFit::Result> FixedPoseFit::solve() const {
  if (sightings_.empty()) return std::nullopt;
  const std::size_t count = sightings_.size();
  Poses poses{start(), std::vector<RigidTransform>(count)};
  for (std::size_t s = 0; s < count; ++s) {
    transfer_error_px(sightings_[s], poses.first_from_second, &poses.second_from_target[s]);
  }
  constexpr double damping = 1e-4;
  constexpr int most_steps = 60;
  std::vector<double> own_weights;
  levenberg_marquardt(
      poses, damping, most_steps,
      [&](const Poses& at) {
        own_weights = weights(at);
        return linearise(at, own_weights);
      },
      [&](const Poses& from, const Linearised::Step& step) {
        Poses next{to_transform(step.transform) * from.first_from_second, {}};
        for (std::size_t s = 0; s < count; ++s) {
          next.second_from_target.push_back(to_transform(step.targets[s]) *
                                            from.second_from_target[s]);
        }
        return next;
      },
      [&](const Poses& at) {
        double cost = 0;
        for (std::size_t s = 0; s < count; ++s) {
          cost += own_weights[s] *
                  squared_error(sightings_[s], at.first_from_second, at.second_from_target[s]);
        }
        return cost;
      });
  return summarise(poses, own_weights);
}

std::optional<FixedPoseFit::Result> FixedPoseFit::summarise(
    const Poses& poses, const std::vector<double>& weights) const {
  const std::vector<double> errors = errors_px(poses);
  Result result;
  result.first_from_second = poses.first_from_second;
  double squares = 0;
  double least_squares = 0;
  double corners = 0;
  for (std::size_t s = 0; s < sightings_.size(); ++s) {
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
  std::vector<Matrix6d> inverses;
  const Matrix6d information = linearise(poses, weights).eliminate(0, inverses).squares;
  const Matrix6d covariance = information.ldlt().solve(Matrix6d::Identity()) * (squares / freedom);
  result.deviation_deg =
      std::sqrt(std::max(0.0, covariance.diagonal().head<3>().maxCoeff())) * 180 / std::numbers::pi;
  result.deviation_m = std::sqrt(std::max(0.0, covariance.diagonal().tail<3>().maxCoeff()));
  return result;
}

}  // namespace diminish
