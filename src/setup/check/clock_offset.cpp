#include "setup/check/clock_offset.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/robust.h"

namespace diminish {
namespace {

constexpr std::size_t least_points = 6;

struct Fit {
  double mean_square = std::numeric_limits<double>::infinity();  ///< of the distances, m^2
  double information = 0;  ///< sum of squared speeds, minus their mean
  std::size_t count = 0;
};

/// The point of the path at a moment; nothing outside it or in a gap.
std::optional<Eigen::Vector3d> interpolate(const std::vector<TimedPoint>& way, double stamp_s,
                                           double largest_gap_s, Eigen::Vector3d& velocity) {
  const auto after = std::upper_bound(way.begin(), way.end(), stamp_s,
                                      [](double t, const TimedPoint& p) { return t < p.stamp_s; });
  if (after == way.begin() || after == way.end()) return std::nullopt;
  const auto before = after - 1;
  const double gap = after->stamp_s - before->stamp_s;
  if (!(gap > 0) || gap > largest_gap_s) return std::nullopt;
  // The speed over a longer time: from one image to the next it would be mostly noise.
  constexpr std::ptrdiff_t reach = 5;
  const auto earlier = before - std::min(reach, before - way.begin());
  const auto later = after + std::min(reach, way.end() - 1 - after);
  velocity = (later->place - earlier->place) / (later->stamp_s - earlier->stamp_s);
  return before->place + (stamp_s - before->stamp_s) / gap * (after->place - before->place);
}

Fit fit(const std::vector<TimedPoint>& first, const std::vector<TimedPoint>& second,
        double offset_s, double largest_gap_s) {
  std::vector<Eigen::Vector3d> differences;
  std::vector<Eigen::Vector3d> velocities;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_velocity = Eigen::Vector3d::Zero();
  for (const TimedPoint& point : second) {
    Eigen::Vector3d velocity;
    const auto place = interpolate(first, point.stamp_s - offset_s, largest_gap_s, velocity);
    if (!place) continue;
    differences.emplace_back(*place - point.place);
    velocities.push_back(velocity);
    mean += differences.back();
    mean_velocity += velocity;
  }
  Fit result;
  result.count = differences.size();
  // The paths must overlap for most of their length.
  if (result.count < least_points || 2 * result.count < second.size()) return result;
  const auto n = static_cast<double>(result.count);
  mean /= n;
  mean_velocity /= n;
  double squares = 0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    squares += (differences[i] - mean).squaredNorm();
    result.information += (velocities[i] - mean_velocity).squaredNorm();
  }
  result.mean_square = squares / n;
  return result;
}

}  // namespace

std::optional<ClockOffset> estimate_clock_offset(const std::vector<TimedPoint>& first,
                                                 const std::vector<TimedPoint>& second,
                                                 double largest_s) {
  if (first.size() < least_points || second.size() < least_points) return std::nullopt;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < first.size(); ++i) {
    gaps.push_back(first[i].stamp_s - first[i - 1].stamp_s);
  }
  const double largest_gap_s = 3 * median(gaps);
  constexpr double step_s = 0.004;
  const auto at = [&](double offset_s) { return fit(first, second, offset_s, largest_gap_s); };
  double best_offset = 0;
  Fit best;
  const int steps = static_cast<int>(largest_s / step_s);
  for (int i = -steps; i <= steps; ++i) {
    const Fit candidate = at(i * step_s);
    if (candidate.mean_square < best.mean_square) {
      best = candidate;
      best_offset = i * step_s;
    }
  }
  if (!std::isfinite(best.mean_square) || !(best.information > 0)) return std::nullopt;
  // The parabola through the best value and its neighbours.
  const double left = at(best_offset - step_s).mean_square;
  const double right = at(best_offset + step_s).mean_square;
  const double curvature = left + right - 2 * best.mean_square;
  if (std::isfinite(curvature) && curvature > 0) {
    best_offset += std::clamp(0.5 * (left - right) / curvature, -1.0, 1.0) * step_s;
  }
  const double noise = best.mean_square / 3 * static_cast<double>(best.count) /
                       std::max(1.0, static_cast<double>(best.count) - 2);
  return ClockOffset{best_offset, std::sqrt(noise / best.information)};
}

}  // namespace diminish
