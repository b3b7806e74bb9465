#include "detect/round_shape.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "core/robust.h"

namespace diminish {
namespace {

using Points = std::vector<cv::Point>;

/// How far out a point is: 1 on the ellipse, less inside.
class RelativeRadius {
 public:
  explicit RelativeRadius(const RoundShape& shape)
      : center_(shape.center),
        first_axis_(cv::Point2d(std::cos(shape.angle_rad), std::sin(shape.angle_rad)) /
                    shape.half_axes.width),
        second_axis_(cv::Point2d(-std::sin(shape.angle_rad), std::cos(shape.angle_rad)) /
                     shape.half_axes.height) {}

  double operator()(double x, double y) const {
    const cv::Point2d from_center = cv::Point2d(x, y) - center_;
    const double first = first_axis_.dot(from_center);
    const double second = second_axis_.dot(from_center);
    return std::sqrt(first * first + second * second);
  }

  /// Where a row comes nearest to the centre.
  double nearest_column(double y) const {
    const double squares = first_axis_.x * first_axis_.x + second_axis_.x * second_axis_.x;
    const double mixed = first_axis_.x * first_axis_.y + second_axis_.x * second_axis_.y;
    return center_.x - mixed / squares * (y - center_.y);
  }

 private:
  cv::Point2d center_, first_axis_, second_axis_;
};

RoundShape fit_ellipse(const Points& points) {
  const cv::RotatedRect fit = cv::fitEllipseDirect(points);
  return {fit.center, fit.size / 2.f, fit.angle * std::numbers::pi / 180};
}

/// Least squares on x^2 + y^2 = 2 a x + 2 b y + c (Kasa 1976).
RoundShape fit_circle(const Points& points) {
  Eigen::MatrixX3d system(points.size(), 3);
  Eigen::VectorXd squares(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = points[i].x;
    const double y = points[i].y;
    system.row(i) << 2 * x, 2 * y, 1;
    squares[i] = x * x + y * y;
  }
  const Eigen::Vector3d solution = system.colPivHouseholderQr().solve(squares);
  const double radius = std::sqrt(solution[2] + solution.head<2>().squaredNorm());
  return {{solution[0], solution[1]}, {radius, radius}, 0};
}

/// The points without those that are much further from the shape than half of them are.
Points without_outliers(const Points& points, const RoundShape& shape) {
  const RelativeRadius relative_radius(shape);
  const double radius = shape.diameter() / 2;
  std::vector<double> distances;
  for (const cv::Point& point : points) {
    distances.push_back(std::abs(relative_radius(point.x, point.y) - 1) * radius);
  }
  std::vector<double> sorted = distances;
  const double limit = std::max(1.0, 2.5 * median(sorted));
  Points kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (distances[i] <= limit) kept.push_back(points[i]);
  }
  return kept;
}

double intersection_over_union(const RoundShape& shape, const cv::Mat& region) {
  cv::Mat drawn = cv::Mat::zeros(region.size(), CV_8U);
  shape.draw(drawn);
  const int both = cv::countNonZero(drawn & region);
  const int either = cv::countNonZero(drawn | region);
  return either > 0 ? static_cast<double>(both) / either : 0;
}

/// How fast the squared relative radius grows with the squared distance along a row, as a root.
double relative_slope(const RelativeRadius& relative_radius, double middle, double y) {
  const double there = relative_radius(middle, y);
  const double beside = relative_radius(middle + 1, y);
  return std::sqrt(std::max(beside * beside - there * there, 0.0));
}

bool usable(const RoundShape& shape) {
  const double smaller = std::min(shape.half_axes.width, shape.half_axes.height);
  return std::isfinite(shape.center.x + shape.center.y + shape.diameter()) && smaller > 0.5;
}

}  // namespace

void RoundShape::draw(cv::Mat& mask) const {
  const RelativeRadius relative_radius(*this);
  const double reach = std::max(half_axes.width, half_axes.height);
  const int top = static_cast<int>(std::ceil(std::max(center.y - reach, 0.0)));
  const int bottom = static_cast<int>(std::floor(std::min(center.y + reach, mask.rows - 1.0)));
  for (int y = top; y <= bottom; ++y) {
    const double middle = relative_radius.nearest_column(y);
    const double radius = relative_radius(middle, y);
    if (radius > 1) continue;
    // The row's half width, then the last pixel on each side whose centre is inside.
    const double half_width = std::sqrt(1 - radius * radius) /
                              std::max(relative_slope(relative_radius, middle, y), 1e-12);
    int first = static_cast<int>(std::ceil(std::max(middle - half_width, 0.0)));
    int last = static_cast<int>(std::floor(std::min(middle + half_width, mask.cols - 1.0)));
    while (first > 0 && relative_radius(first - 1, y) <= 1) --first;
    while (first <= last && relative_radius(first, y) > 1) ++first;
    while (last + 1 < mask.cols && relative_radius(last + 1, y) <= 1) ++last;
    while (last >= first && relative_radius(last, y) > 1) --last;
    if (first <= last) {
      std::fill(mask.ptr<std::uint8_t>(y) + first, mask.ptr<std::uint8_t>(y) + last + 1,
                std::uint8_t{255});
    }
  }
}

std::optional<RoundShape> fit_round_shape(const Points& outline, const cv::Mat& region) {
  const cv::Rect inner(1, 1, region.cols - 2, region.rows - 2);
  Points points;
  std::copy_if(outline.begin(), outline.end(), std::back_inserter(points),
               [&](const cv::Point& point) { return inner.contains(point); });
  const auto fit = points.size() == outline.size() ? fit_ellipse : fit_circle;
  constexpr std::size_t fewest_points = 8;
  if (points.size() < fewest_points) return std::nullopt;
  RoundShape shape = fit(points);
  if (!usable(shape)) return std::nullopt;
  // The first fit is drawn towards what does not belong to the outline, the later ones less.
  for (int pass = 0; pass < 4; ++pass) {
    const Points good = without_outliers(points, shape);
    if (good.size() < fewest_points) break;
    shape = fit(good);
    if (!usable(shape)) return std::nullopt;
  }
  // The outline leads through the centres of the region's outermost pixels.
  shape.half_axes += cv::Size2d(0.5, 0.5);
  shape.agreement = intersection_over_union(shape, region);
  return shape;
}

bool is_round(const RoundShape& shape) {
  // A ball 45 degrees off the axis is 1.4 times as long as wide.
  constexpr double smallest_aspect = 0.6;
  constexpr double smallest_agreement = 0.85;
  const auto [shorter, longer] = std::minmax(shape.half_axes.width, shape.half_axes.height);
  return shorter >= smallest_aspect * longer && shape.agreement >= smallest_agreement;
}

}  // namespace diminish
