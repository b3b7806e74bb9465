#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

namespace diminish {

/// An ellipse, or a circle if both half axes are the same.
struct Ellipse {
  Eigen::Vector2d center{0, 0};
  Eigen::Vector2d half_axes{0, 0};
  double angle_rad = 0;  ///< of the first axis
};

/// The sums of x^i y^j over points, for i + j up to 4: all that fitting a conic takes. Coordinates
/// are from a point near the points' middle, in units of their extent, so that the sums are of
/// similar size.
class Moments {
 public:
  Moments(const Eigen::Vector2d& origin, double unit) : origin_(origin), unit_(unit) {}

  void add(const Eigen::Vector2d& point) {
    const Eigen::Vector2d from_origin = (point - origin_) / unit_;
    const double x = from_origin.x();
    const double y = from_origin.y();
    const std::array<double, 5> x_powers = {1, x, x * x, x * x * x, x * x * x * x};
    double y_power = 1;
    for (int j = 0; j < 5; ++j, y_power *= y) {
      for (int i = 0; i + j < 5; ++i) sums_[i][j] += x_powers[i] * y_power;
    }
  }

  /// The ellipse of the least sum of squared algebraic distances (Fitzgibbon, Pilu & Fisher 1999,
  /// in the form of Halir & Flusser 1998); absent if the points determine none.
  std::optional<Ellipse> fit_ellipse() const;
  /// Least squares on x^2 + y^2 = 2 a x + 2 b y + c (Kasa 1976).
  std::optional<Ellipse> fit_circle() const;

 private:
  Ellipse in_pixels(Ellipse ellipse) const;

  Eigen::Vector2d origin_;
  double unit_;
  std::array<std::array<double, 5>, 5> sums_{};
};

}  // namespace diminish
