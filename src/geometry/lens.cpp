#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "diminish/intrinsics.h"

namespace diminish {
namespace {

/// The squared radius at which the radial polynomial r (1 + k1 r^2 + k2 r^4 + k3 r^6) stops
/// growing.
double monotonic_radius_squared(const std::array<double, 5>& distortion) {
  const auto [k1, k2, p1, p2, k3] = distortion;
  const auto slope = [k1 = k1, k2 = k2, k3 = k3](double r2) {
    return 1 + r2 * (3 * k1 + r2 * (5 * k2 + r2 * 7 * k3));
  };
  // Up to a field of view of about 170 degrees; beyond that no such lens is used.
  constexpr double largest = 130;
  constexpr int steps = 2000;
  double below = 0;
  for (int i = 1; i <= steps; ++i) {
    double above = largest * i * i / (double{steps} * steps);
    if (slope(above) <= 0) {
      for (int halving = 0; halving < 50; ++halving) {
        const double middle = (below + above) / 2;
        (slope(middle) > 0 ? below : above) = middle;
      }
      return below;
    }
    below = above;
  }
  return largest;
}

}  // namespace

Lens::Lens(const Intrinsics& intrinsics)
    : intrinsics_(intrinsics),
      max_radius_squared_(monotonic_radius_squared(intrinsics.distortion)) {}

std::optional<Eigen::Vector2d> Lens::distort(const Eigen::Vector2d& ray) const {
  const auto [k1, k2, p1, p2, k3] = intrinsics_.distortion;
  const double x = ray.x();
  const double y = ray.y();
  const double r2 = x * x + y * y;
  if (!(r2 < max_radius_squared_)) return std::nullopt;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double xd = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
  const double yd = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  return Eigen::Vector2d(intrinsics_.fx * xd + intrinsics_.cx,
                         intrinsics_.fy * yd + intrinsics_.cy);
}

std::optional<Eigen::Vector2d> Lens::project(const Eigen::Vector3d& x_in_camera) const {
  if (!(x_in_camera.z() > 1e-6)) return std::nullopt;
  return distort(x_in_camera.head<2>() / x_in_camera.z());
}

Eigen::Vector2d Lens::undistort(const Eigen::Vector2d& pixel) const {
  const auto [k1, k2, p1, p2, k3] = intrinsics_.distortion;
  const Eigen::Vector2d target((pixel.x() - intrinsics_.cx) / intrinsics_.fx,
                               (pixel.y() - intrinsics_.cy) / intrinsics_.fy);
  Eigen::Vector2d ray = target;
  constexpr int max_iterations = 20;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const double x = ray.x();
    const double y = ray.y();
    const double r2 = x * x + y * y;
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double slope = k1 + r2 * (2 * k2 + r2 * 3 * k3);  // d radial / d r2
    const Eigen::Vector2d error(x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) - target.x(),
                                y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y - target.y());
    Eigen::Matrix2d jacobian;
    jacobian << radial + 2 * x * x * slope + 2 * p1 * y + 6 * p2 * x,
        2 * x * y * slope + 2 * p1 * x + 2 * p2 * y,  //
        2 * x * y * slope + 2 * p1 * x + 2 * p2 * y,
        radial + 2 * y * y * slope + 6 * p1 * y + 2 * p2 * x;
    ray -= jacobian.inverse() * error;
    // What is left after this step is of the order of the error's square.
    if (error.squaredNorm() < 1e-10) break;
  }
  return ray;
}

Image<Eigen::Vector2f> Lens::rays() const {
  Image<Eigen::Vector2f> rays(intrinsics_.width, intrinsics_.height, Eigen::Vector2f::Zero());
  for (int y = 0; y < rays.height(); ++y) {
    for (int x = 0; x < rays.width(); ++x) rays(x, y) = undistort({x, y}).cast<float>();
  }
  return rays;
}

}  // namespace diminish
