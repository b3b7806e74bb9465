#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

namespace diminish {

/// An ellipse, or a circle if both half axes are equal.
struct Ellipse {
  Eigen::Vector2d center{0, 0};
  Eigen::Vector2d half_axes{0, 0};
  double angle_rad = 0;  ///< of the first axis
};

/// The sums of x^i y^j over points, for i + j up to 4: all that a conic fit needs. Coordinates are
/// relative to a point near the points' centre, in units of their extent, so that the sums have
/// similar sizes.
class Moments {
 public:
  Moments(const Eigen::Vector2d& origin, double unit) : origin_(origin), per_unit_(1 / unit) {}

  void add(const Eigen::Vector2d& point) {
    const double x = (point.x() - origin_.x()) * per_unit_;
    const double y = (point.y() - origin_.y()) * per_unit_;
    const double xx = x * x;
    const double xy = x * y;
    const double yy = y * y;
    sums_[0][0] += 1;
    sums_[1][0] += x;
    sums_[0][1] += y;
    sums_[2][0] += xx;
    sums_[1][1] += xy;
    sums_[0][2] += yy;
    sums_[3][0] += xx * x;
    sums_[2][1] += xx * y;
    sums_[1][2] += x * yy;
    sums_[0][3] += yy * y;
    sums_[4][0] += xx * xx;
    sums_[3][1] += xx * xy;
    sums_[2][2] += xx * yy;
    sums_[1][3] += xy * yy;
    sums_[0][4] += yy * yy;
  }

  /// The ellipse with the least sum of squared algebraic distances (Fitzgibbon, Pilu & Fisher 1999,
  /// in the form of Halir & Flusser 1998); nothing if the points do not determine one.
  std::optional<Ellipse> fit_ellipse() const;
  /// Least squares on x^2 + y^2 = 2 a x + 2 b y + c (Kasa 1976).
  std::optional<Ellipse> fit_circle() const;

 private:
  Ellipse in_pixels(Ellipse ellipse) const;

  Eigen::Vector2d origin_;
  double per_unit_;
  std::array<std::array<double, 5>, 5> sums_{};
};

}  // namespace diminish
