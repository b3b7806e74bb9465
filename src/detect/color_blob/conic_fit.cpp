#include "detect/color_blob/conic_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace diminish {
namespace {

/// The ellipse a x^2 + b x y + c y^2 + d x + e y + f = 0; nothing if it is not an ellipse.
std::optional<Ellipse> ellipse_of_conic(const Eigen::Vector3d& quadratic,
                                        const Eigen::Vector3d& linear) {
  Eigen::Matrix2d form;
  form << quadratic[0], quadratic[1] / 2, quadratic[1] / 2, quadratic[2];
  const double determinant = form.determinant();
  if (!(determinant > 0)) return std::nullopt;
  Ellipse ellipse;
  ellipse.center = -0.5 * form.inverse() * linear.head<2>();
  const double at_center = linear[2] + linear.head<2>().dot(ellipse.center) / 2;
  const double mean = form.trace() / 2;
  const double difference = std::hypot((form(0, 0) - form(1, 1)) / 2, form(0, 1));
  // The eigenvalues of the form, the first one for the first axis. Both have the form's sign.
  const double first = mean + std::copysign(difference, mean);
  const Eigen::Vector2d squares(-at_center / first, -at_center * first / determinant);
  if (!(squares.minCoeff() > 0)) return std::nullopt;
  ellipse.half_axes = squares.cwiseSqrt();
  const double sign = std::copysign(1.0, mean);
  ellipse.angle_rad = std::atan2(sign * 2 * form(0, 1), sign * (form(0, 0) - form(1, 1))) / 2;
  return ellipse;
}

}  // namespace

std::optional<Ellipse> Moments::fit_ellipse() const {
  const auto& s = sums_;
  Eigen::Matrix3d quadratic;  // S1, S2 and S3 of Halir & Flusser
  Eigen::Matrix3d mixed;
  Eigen::Matrix3d linear;
  quadratic << s[4][0], s[3][1], s[2][2], s[3][1], s[2][2], s[1][3], s[2][2], s[1][3], s[0][4];
  mixed << s[3][0], s[2][1], s[2][0], s[2][1], s[1][2], s[1][1], s[1][2], s[0][3], s[0][2];
  linear << s[2][0], s[1][1], s[1][0], s[1][1], s[0][2], s[0][1], s[1][0], s[0][1], s[0][0];
  Eigen::Matrix3d inverse;
  bool invertible = false;
  linear.computeInverseWithCheck(inverse, invertible);
  if (!invertible) return std::nullopt;
  const Eigen::Matrix3d linear_from_quadratic = -inverse * mixed.transpose();
  const Eigen::Matrix3d reduced = quadratic + mixed * linear_from_quadratic;
  Eigen::Matrix3d system;
  system << reduced.row(2) / 2, -reduced.row(1), reduced.row(0) / 2;
  const Eigen::EigenSolver<Eigen::Matrix3d> solver(system);
  if (solver.info() != Eigen::Success) return std::nullopt;
  // One of the three solutions is an ellipse.
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d conic = solver.eigenvectors().col(i).real();
    if (4 * conic[0] * conic[2] - conic[1] * conic[1] <= 0) continue;
    const auto ellipse = ellipse_of_conic(conic, linear_from_quadratic * conic);
    if (ellipse) return in_pixels(*ellipse);
  }
  return std::nullopt;
}

std::optional<Ellipse> Moments::fit_circle() const {
  const auto& s = sums_;
  Eigen::Matrix3d normal;
  normal << s[2][0], s[1][1], s[1][0], s[1][1], s[0][2], s[0][1], s[1][0], s[0][1], s[0][0];
  const Eigen::Vector3d right(s[3][0] + s[1][2], s[2][1] + s[0][3], s[2][0] + s[0][2]);
  Eigen::Matrix3d inverse;
  bool invertible = false;
  normal.computeInverseWithCheck(inverse, invertible);
  if (!invertible) return std::nullopt;
  const Eigen::Vector3d solution = inverse * right;
  const Eigen::Vector2d center = solution.head<2>() / 2;
  const double squared_radius = solution[2] + center.squaredNorm();
  if (!(squared_radius > 0)) return std::nullopt;
  return in_pixels({center, Eigen::Vector2d::Constant(std::sqrt(squared_radius)), 0});
}

Ellipse Moments::in_pixels(Ellipse ellipse) const {
  ellipse.center = origin_ + ellipse.center / per_unit_;
  ellipse.half_axes /= per_unit_;
  return ellipse;
}

}  // namespace diminish
