#include "detect/color_blob/round_shape.h"

#include <algorithm>
#include <cmath>

#include "core/robust.h"

namespace diminish {
namespace {

constexpr int fewest_points = 8;

/// The relative radius of a point: 1 on the ellipse, less inside.
class RelativeRadius {
 public:
  explicit RelativeRadius(const Ellipse& ellipse)
      : center_(ellipse.center),
        first_axis_(Eigen::Vector2d(std::cos(ellipse.angle_rad), std::sin(ellipse.angle_rad)) /
                    ellipse.half_axes[0]),
        second_axis_(Eigen::Vector2d(-std::sin(ellipse.angle_rad), std::cos(ellipse.angle_rad)) /
                     ellipse.half_axes[1]) {}

  double operator()(double x, double y) const {
    const Eigen::Vector2d from_center = Eigen::Vector2d(x, y) - center_;
    const double first = first_axis_.dot(from_center);
    const double second = second_axis_.dot(from_center);
    return std::sqrt(first * first + second * second);
  }

  /// Where a row comes nearest to the centre.
  double nearest_column(double y) const {
    const double squares = slope() * slope();
    const double mixed = first_axis_.x() * first_axis_.y() + second_axis_.x() * second_axis_.y();
    return center_.x() - mixed / squares * (y - center_.y());
  }

  /// The square root of the factor by which the squared relative radius grows with the squared
  /// distance from there.
  double slope() const { return std::hypot(first_axis_.x(), second_axis_.x()); }

 private:
  Eigen::Vector2d center_, first_axis_, second_axis_;
};

/// Calls visit(y, begin, end) for each row of the pixels of `part` whose centres are inside.
template <class Visit>
void for_each_row(const Ellipse& ellipse, const Rect& part, const Visit& visit) {
  const RelativeRadius relative_radius(ellipse);
  const double reach = ellipse.half_axes.maxCoeff();
  const auto first_row = std::max<double>(ellipse.center.y() - reach, part.y);
  const auto last_row = std::min<double>(ellipse.center.y() + reach, part.bottom() - 1);
  for (int y = static_cast<int>(std::ceil(first_row)); y <= last_row; ++y) {
    const double middle = relative_radius.nearest_column(y);
    const double radius = relative_radius(middle, y);
    if (radius > 1) continue;
    const double half_width = std::sqrt(1 - radius * radius) / relative_radius.slope();
    const auto left = std::max<double>(middle - half_width, part.x);
    const auto right = std::min<double>(middle + half_width, part.right() - 1);
    // Both are rounded, so the radius decides.
    int first = static_cast<int>(std::ceil(left));
    int last = static_cast<int>(std::floor(right));
    while (first > part.x && relative_radius(first - 1, y) <= 1) --first;
    while (first <= last && relative_radius(first, y) > 1) ++first;
    while (last + 1 < part.right() && relative_radius(last + 1, y) <= 1) ++last;
    while (last >= first && relative_radius(last, y) > 1) --last;
    if (first <= last) visit(y, first, last + 1);
  }
}

/// picture: as for RoundShapeFitter::fit.
double intersection_over_union(const Ellipse& ellipse, const Mask& region, const Rect& picture) {
  std::size_t inside = 0;
  std::size_t both = 0;
  for_each_row(ellipse, picture, [&](int y, int begin, int end) {
    inside += static_cast<std::size_t>(end - begin);
    both += count_nonzero(region, intersect({begin, y, end - begin, 1}, region.bounds()));
  });
  const std::size_t either = inside + count_nonzero(region, region.bounds()) - both;
  return either > 0 ? static_cast<double>(both) / static_cast<double>(either) : 0;
}

bool is_usable(const Ellipse& ellipse) {
  return std::isfinite(ellipse.center.sum() + ellipse.half_axes.sum()) &&
         ellipse.half_axes.minCoeff() > 0.5;
}

}  // namespace

bool is_round(const RoundShape& shape) {
  // A ball 45 degrees off the axis is 1.4 times as long as wide.
  constexpr double smallest_aspect = 0.6;
  constexpr double smallest_agreement = 0.85;
  const Eigen::Vector2d& half_axes = shape.ellipse.half_axes;
  return half_axes.minCoeff() >= smallest_aspect * half_axes.maxCoeff() &&
         shape.agreement >= smallest_agreement;
}

void draw(const Ellipse& ellipse, Mask& mask) {
  for_each_row(ellipse, mask.bounds(), [&](int y, int begin, int end) {
    std::fill(mask.row(y) + begin, mask.row(y) + end, std::uint8_t{255});
  });
}

std::optional<RoundShape> RoundShapeFitter::fit(const Outline& outline, const Mask& region,
                                                const Rect& picture) {
  const Rect inner = grow(picture, -1);
  points_.clear();
  std::copy_if(outline.begin(), outline.end(), std::back_inserter(points_),
               [&](const Eigen::Vector2i& point) { return inner.contains(point.x(), point.y()); });
  if (points_.size() < fewest_points) return std::nullopt;
  const bool is_cut_off = points_.size() != outline.size();
  box_.setEmpty();
  for (const Eigen::Vector2i& point : points_) box_.extend(point);
  good_.assign(points_.size(), 1);
  std::optional<Ellipse> ellipse = fit_good_points(is_cut_off);
  // Points that do not belong to the outline pull the first fit, and later ones less.
  for (int pass = 0; pass < 4 && ellipse && is_usable(*ellipse); ++pass) {
    if (!leave_out_outliers(*ellipse)) break;
    ellipse = fit_good_points(is_cut_off);
  }
  if (!ellipse || !is_usable(*ellipse)) return std::nullopt;
  // The outline runs through the centres of the region's outermost pixels.
  ellipse->half_axes += Eigen::Vector2d(0.5, 0.5);
  return RoundShape{*ellipse, intersection_over_union(*ellipse, region, picture)};
}

bool RoundShapeFitter::leave_out_outliers(const Ellipse& ellipse) {
  const RelativeRadius relative_radius(ellipse);
  const double radius = ellipse.half_axes.sum() / 2;
  distances_px_.resize(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double off = relative_radius(points_[i].x(), points_[i].y()) - 1;
    distances_px_[i] = static_cast<float>(std::abs(off) * radius);
  }
  sorted_ = distances_px_;
  const float limit = std::max(1.F, 2.5F * median(sorted_));
  if (std::count_if(distances_px_.begin(), distances_px_.end(),
                    [&](float distance) { return distance <= limit; }) < fewest_points) {
    return false;
  }
  bool changed = false;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const char good = distances_px_[i] <= limit ? 1 : 0;
    changed = changed || good != good_[i];
    good_[i] = good;
  }
  return changed;
}

std::optional<Ellipse> RoundShapeFitter::fit_good_points(bool is_cut_off) const {
  Moments moments(box_.center().cast<double>(), std::max(1, box_.sizes().maxCoeff()) / 2.0);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (good_[i] != 0) moments.add(points_[i].cast<double>());
  }
  return is_cut_off ? moments.fit_circle() : moments.fit_ellipse();
}

}  // namespace diminish
