#include "pose/corner_refinement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "pose/profile.h"

namespace diminish {
namespace {

using Eigen::Vector2d;

constexpr int max_profile_samples = Profile::most - 1;
constexpr std::size_t max_profiles = 64;
constexpr float min_step_levels = 12;  ///< a weaker edge is not a marker's
constexpr double min_support = 0.4;    ///< share of a side's profiles that must see its edge
constexpr double min_reach_px = 2.5;
constexpr double near_px = 1;  ///< points up to this far apart are on the same edge

/// The place of the dark-to-light step on the profile through `center` along `outward`: the
/// centroid of the rise in brightness around its steepest point.
std::optional<Vector2d> find_step(ImageView<Bgr> image, const Vector2d& center,
                                  const Vector2d& outward, double reach_px, double step_px) {
  const auto inside = [&](const Vector2d& point) {
    return point.x() >= 0 && point.y() >= 0 && point.x() < image.width() - 1.001 &&
           point.y() < image.height() - 1.001;
  };
  int count = std::min(2 * static_cast<int>(reach_px / step_px), max_profile_samples);
  double half_length = 0.5 * count * step_px;
  // Profiles are shorter at the picture's edge.
  while (!inside(center - half_length * outward) || !inside(center + half_length * outward)) {
    count /= 2;
    half_length = 0.5 * count * step_px;
    if (half_length < min_reach_px) return std::nullopt;
  }
  const Vector2d first = center - half_length * outward;
  const Eigen::Vector2f start = first.cast<float>();
  const Eigen::Vector2f step = (step_px * outward).cast<float>();
  std::array<float, Profile::room> levels;
  sample_profile(image, {start.x(), start.y(), step.x(), step.y(), count + 1}, levels.data());
  const auto rise = [&](int i) {
    return levels[static_cast<std::size_t>(i + 1)] - levels[static_cast<std::size_t>(i)];
  };
  int steepest = 0;
  float most = rise(0);
  for (int i = 1; i < count; ++i) {
    if (rise(i) <= most) continue;
    most = rise(i);
    steepest = i;
  }
  // The steepest point's neighbourhood must lie inside the profile. Otherwise the edge is somewhere
  // else.
  const int window = static_cast<int>(2 / step_px);
  if (steepest < window || steepest >= count - window) return std::nullopt;
  float weight = 0;
  float moment = 0;
  for (int i = steepest - window; i <= steepest + window; ++i) {
    const float positive = std::max(0.F, rise(i));
    weight += positive;
    moment += positive * (static_cast<float>(i) + 0.5F);
  }
  if (weight < min_step_levels) return std::nullopt;
  return first + static_cast<double>(moment / weight) * step_px * outward;
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

/// The line through two of the points that most others are near. Ignores points on another edge,
/// and keeps those near the line.
void keep_largest_line(Points& points, double near) {
  const Vector2d* best_a = nullptr;
  const Vector2d* best_b = nullptr;
  int most = 0;
  const auto all = static_cast<int>(points.size());
  for (const Vector2d* a = points.begin(); a != points.end() && most < all; ++a) {
    for (const Vector2d* b = a + 1; b != points.end() && most < all; ++b) {
      const Vector2d normal = Vector2d(b->y() - a->y(), a->x() - b->x()).normalized();
      int count = 0;
      for (const Vector2d& point : points) count += std::abs(normal.dot(point - *a)) < near ? 1 : 0;
      if (count > most) {
        most = count;
        best_a = a;
        best_b = b;
      }
    }
  }
  if (!best_a) return;
  const Vector2d origin = *best_a;
  const Vector2d normal = Vector2d(best_b->y() - origin.y(), origin.x() - best_b->x()).normalized();
  points.remove_if(
      [&](const Vector2d& point) { return std::abs(normal.dot(point - origin)) >= near; });
}

/// Fits a line {x : normal . x = offset} by total least squares, twice: the second time without the
/// points that are far from the first line.
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

bool refine_corners(ImageView<Bgr> image, const Lens& lens, int modules, const RefinementPass& pass,
                    std::array<Vector2d, 4>& corners) {
  std::array<std::optional<Eigen::Hyperplane<double, 2>>, 4> sides;
  for (std::size_t side = 0; side < 4; ++side) {
    const Vector2d& from = corners[side];
    const Vector2d along = corners[(side + 1) % 4] - from;
    const double length = along.norm();
    if (length < 8) return false;
    // Clockwise corners with y down: the outside is to the left of the direction of travel.
    const Vector2d outward = Vector2d(along.y(), -along.x()) / length;
    const double reach_px = std::clamp(0.8 * length / modules, 3.0, pass.reach_px);
    // Blur rounds corners, so they say nothing about the sides.
    const double end = std::clamp(3.0 / length, 0.06, 0.25);
    const int count = std::clamp(static_cast<int>(length), 8, pass.profiles);
    const double fewest = min_support * count;
    Points points;
    for (int i = 0; i < count; ++i) {
      if (static_cast<double>(points.size()) + count - i < fewest) return false;
      const double t = end + (1 - 2 * end) * (i + 0.5) / count;
      if (const auto step = find_step(image, from + t * along, outward, reach_px, pass.step_px)) {
        points.add(lens.undistort(*step));
      }
    }
    if (pass.expect_outliers) {
      keep_largest_line(points, near_px / std::max(1.0, lens.intrinsics().fx));
    }
    if (static_cast<double>(points.size()) >= fewest) sides[side] = fit_line(points);
    if (!sides[side]) return false;
  }
  std::array<Vector2d, 4> refined;
  for (std::size_t corner = 0; corner < 4; ++corner) {
    const auto meeting = lens.distort(sides[(corner + 3) % 4]->intersection(*sides[corner]));
    // A corner that moved too far belongs to something beside the marker.
    if (!meeting || !((*meeting - corners[corner]).norm() < 2 * pass.reach_px)) return false;
    refined[corner] = *meeting;
  }
  corners = refined;
  return true;
}

}  // namespace diminish
