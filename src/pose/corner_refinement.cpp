#include "pose/corner_refinement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace diminish {
namespace {

using Eigen::Vector2d;

constexpr double profile_step_px = 0.5;
constexpr int max_profile_samples = 64;
constexpr std::size_t max_profiles = 64;
constexpr double min_step_levels = 12;  ///< a weaker edge than this is not a marker's

double sample(const Image<std::uint8_t>& gray, const Vector2d& at) {
  const double x = std::clamp(at.x(), 0.0, gray.width() - 1.001);
  const double y = std::clamp(at.y(), 0.0, gray.height() - 1.001);
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const double fx = x - x0;
  const double fy = y - y0;
  return (1 - fy) * ((1 - fx) * gray(x0, y0) + fx * gray(x0 + 1, y0)) +
         fy * ((1 - fx) * gray(x0, y0 + 1) + fx * gray(x0 + 1, y0 + 1));
}

/// The place of the dark-to-light step on the profile through `center` along `outward`: the
/// centroid of the brightness's rise around its steepest point.
std::optional<Vector2d> find_step(const Image<std::uint8_t>& gray, const Vector2d& center,
                                  const Vector2d& outward, double reach_px) {
  std::array<double, max_profile_samples> rise{};
  const int half = std::min(static_cast<int>(reach_px / profile_step_px), max_profile_samples / 2);
  const int count = 2 * half;
  const auto position = [&](double i) { return (i - half + 0.5) * profile_step_px; };
  double previous = sample(gray, center + (position(0) - 0.5 * profile_step_px) * outward);
  int steepest = 0;
  for (int i = 0; i < count; ++i) {
    const double next = sample(gray, center + (position(i) + 0.5 * profile_step_px) * outward);
    rise[static_cast<std::size_t>(i)] = next - previous;
    previous = next;
    if (rise[static_cast<std::size_t>(i)] > rise[static_cast<std::size_t>(steepest)]) steepest = i;
  }
  // The steepest point's neighbourhood must lie inside the profile, or the edge is elsewhere.
  constexpr int window = 4;
  if (steepest < window || steepest >= count - window) return std::nullopt;
  double weight = 0;
  double moment = 0;
  for (int i = steepest - window; i <= steepest + window; ++i) {
    const double positive = std::max(0.0, rise[static_cast<std::size_t>(i)]);
    weight += positive;
    moment += positive * position(i);
  }
  if (weight < min_step_levels) return std::nullopt;
  return center + (moment / weight) * outward;
}

/// The points found on one side.
class Points {
 public:
  void add(const Vector2d& point) { points_[size_++] = point; }
  std::size_t size() const { return size_; }
  const Vector2d* begin() const { return points_.data(); }
  const Vector2d* end() const { return points_.data() + size_; }
  template <class Remove>
  void remove_if(Remove remove) {
    size_ = static_cast<std::size_t>(
        std::remove_if(points_.data(), points_.data() + size_, remove) - points_.data());
  }

 private:
  std::array<Vector2d, max_profiles> points_;
  std::size_t size_ = 0;
};

/// A line {x : normal . x = offset} fitted to points by total least squares, twice: the second time
/// without the points that are far from the first line.
std::optional<Eigen::Hyperplane<double, 2>> fit_line(Points& points) {
  constexpr std::size_t min_points = 4;
  Eigen::Hyperplane<double, 2> line;
  for (int pass = 0; pass < 2; ++pass) {
    if (points.size() < min_points) return std::nullopt;
    Vector2d mean = Vector2d::Zero();
    for (const Vector2d& point : points) mean += point;
    mean /= static_cast<double>(points.size());
    double xx = 0;
    double xy = 0;
    double yy = 0;
    for (const Vector2d& point : points) {
      const Vector2d d = point - mean;
      xx += d.x() * d.x();
      xy += d.x() * d.y();
      yy += d.y() * d.y();
    }
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    const Vector2d normal(-std::sin(angle), std::cos(angle));
    line = Eigen::Hyperplane<double, 2>(normal, mean);
    double squares = 0;
    for (const Vector2d& point : points) {
      const double distance = line.signedDistance(point);
      squares += distance * distance;
    }
    const double limit = 2 * std::sqrt(squares / static_cast<double>(points.size())) + 1e-12;
    points.remove_if([&](const Vector2d& point) { return line.absDistance(point) > limit; });
  }
  return line;
}

}  // namespace

bool refine_corners(const Image<std::uint8_t>& gray, const Vector2d& origin, const Lens& lens,
                    int modules, const RefinementPass& pass, std::array<Vector2d, 4>& corners) {
  std::array<std::optional<Eigen::Hyperplane<double, 2>>, 4> sides;
  bool all_found = true;
  for (std::size_t side = 0; side < 4; ++side) {
    const Vector2d from = corners[side] - origin;
    const Vector2d along = corners[(side + 1) % 4] - corners[side];
    const double length = along.norm();
    if (length < 8) return false;
    // Clockwise corners with y down: the outside is to the left of the direction of travel.
    const Vector2d outward = Vector2d(along.y(), -along.x()) / length;
    const double reach_px = std::clamp(0.8 * length / modules, 3.0, pass.reach_px);
    // Rounded by blur, the corners themselves say nothing about the sides.
    const double end = std::clamp(3.0 / length, 0.06, 0.25);
    const int count = std::clamp(static_cast<int>(length), 8, pass.profiles);
    Points points;
    for (int i = 0; i < count; ++i) {
      const double t = end + (1 - 2 * end) * (i + 0.5) / count;
      if (const auto step = find_step(gray, from + t * along, outward, reach_px)) {
        points.add(lens.undistort(*step + origin));
      }
    }
    if (points.size() * 2 >= static_cast<std::size_t>(count)) sides[side] = fit_line(points);
    all_found = all_found && sides[side];
  }
  for (std::size_t corner = 0; corner < 4; ++corner) {
    const auto& before = sides[(corner + 3) % 4];
    const auto& after = sides[corner];
    if (!before || !after) continue;
    const auto refined = lens.distort(before->intersection(*after));
    // A corner that ran away is the neighbourhood's, not the marker's.
    if (refined && (*refined - corners[corner]).norm() < 2 * pass.reach_px) {
      corners[corner] = *refined;
    } else {
      all_found = false;
    }
  }
  return all_found;
}

}  // namespace diminish
