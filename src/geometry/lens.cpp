#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "diminish/intrinsics.h"
#include "geometry/distortion.h"

namespace diminish {
namespace {

using Coefficients = std::array<double, 8>;

/// What a ray's radius is multiplied by, tangential distortion left out, and its derivative by the
/// squared radius. Not of a fisheye.
struct Radial {
  double factor, slope;
};

template <LensModel model>
Radial radial_at(const Coefficients& k, double r2) {
  Radial radial{1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4])), k[0] + r2 * (2 * k[1] + r2 * 3 * k[4])};
  if constexpr (model == LensModel::rational) {
    const double divisor = 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
    const double divisor_slope = k[5] + r2 * (2 * k[6] + r2 * 3 * k[7]);
    radial.factor /= divisor;
    radial.slope = (radial.slope - radial.factor * divisor_slope) / divisor;
  }
  return radial;
}

/// A fisheye's distorted radius by the angle off the axis, and its derivative.
struct Bent {
  double radius, slope;
};

Bent bent_at(const Coefficients& k, double angle) {
  const double a2 = angle * angle;
  return {angle * (1 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3])))),
          1 + a2 * (3 * k[0] + a2 * (5 * k[1] + a2 * (7 * k[2] + a2 * 9 * k[3])))};
}

/// Whether the distorted radius is positive and grows with the ray's.
template <LensModel model>
bool grows_at(const Coefficients& k, double r2) {
  if constexpr (model == LensModel::fisheye) {
    const Bent bent = bent_at(k, std::atan(std::sqrt(r2)));
    return bent.radius > 0 && bent.slope > 0;
  } else {
    const auto [factor, slope] = radial_at<model>(k, r2);
    return factor > 0 && factor + 2 * r2 * slope > 0;
  }
}

/// The squared radius at which the distorted radius stops growing.
template <LensModel model>
double monotonic_radius_squared(const Coefficients& k) {
  if (!std::all_of(k.begin(), k.end(), [](double value) { return std::isfinite(value); })) return 0;
  // Up to a field of view of about 170 degrees; beyond that rays (x, y, 1) do not describe a lens.
  constexpr double largest = 130;
  constexpr int steps = 2000;
  double below = 0;
  for (int i = 1; i <= steps; ++i) {
    double above = largest * i * i / (double{steps} * steps);
    if (!grows_at<model>(k, above)) {
      for (int halving = 0; halving < 50; ++halving) {
        const double middle = (below + above) / 2;
        (grows_at<model>(k, middle) ? below : above) = middle;
      }
      return below;
    }
    below = above;
  }
  return largest;
}

template <LensModel model>
Eigen::Vector2d distorted(const Coefficients& k, const Eigen::Vector2d& ray) {
  const double r2 = ray.squaredNorm();
  Eigen::Vector2d result;
  plain::distort_ray<model>(
      k, [](double value) { return value; }, ray.x(), ray.y(), r2, result.x(), result.y());
  return result;
}

/// Newton's method in the plane.
template <LensModel model>
Eigen::Vector2d undistorted(const Coefficients& k, const Eigen::Vector2d& target) {
  const double p1 = k[2];
  const double p2 = k[3];
  Eigen::Vector2d ray = target;
  constexpr int max_iterations = 20;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const double x = ray.x();
    const double y = ray.y();
    const auto [radial, slope] = radial_at<model>(k, x * x + y * y);
    const Eigen::Vector2d error = distorted<model>(k, ray) - target;
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

/// Newton's method on the angle, in which a fisheye is nearly linear; kept between bounds.
Eigen::Vector2d undistorted_fisheye(const Coefficients& k, const Eigen::Vector2d& target,
                                    double max_radius_squared) {
  const double radius = target.norm();
  if (!(radius > 0)) return target;
  double least = 0;
  double greatest = std::atan(std::sqrt(max_radius_squared));
  double angle = std::min(radius, greatest);
  constexpr int max_iterations = 40;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Bent bent = bent_at(k, angle);
    const double error = bent.radius - radius;
    (error < 0 ? least : greatest) = angle;
    const double last = angle;
    angle -= error / bent.slope;
    if (!(angle >= least && angle <= greatest)) angle = (least + greatest) / 2;
    if (std::abs(angle - last) < 1e-13) break;
  }
  return std::tan(angle) / radius * target;
}

}  // namespace

Lens::Lens(const Intrinsics& intrinsics)
    : intrinsics_(intrinsics),
      max_radius_squared_(with_lens_model(intrinsics.lens_model, [&](auto model) {
        return monotonic_radius_squared<decltype(model)::value>(intrinsics.distortion);
      })) {}

std::optional<Eigen::Vector2d> Lens::distort(const Eigen::Vector2d& ray) const {
  if (!(ray.squaredNorm() < max_radius_squared_)) return std::nullopt;
  const Eigen::Vector2d on_plane = with_lens_model(intrinsics_.lens_model, [&](auto model) {
    return distorted<decltype(model)::value>(intrinsics_.distortion, ray);
  });
  return Eigen::Vector2d(intrinsics_.fx * on_plane.x() + intrinsics_.cx,
                         intrinsics_.fy * on_plane.y() + intrinsics_.cy);
}

std::optional<Eigen::Vector2d> Lens::project(const Eigen::Vector3d& x_in_camera) const {
  if (!(x_in_camera.z() > 1e-6)) return std::nullopt;
  return distort(x_in_camera.head<2>() / x_in_camera.z());
}

Eigen::Vector2d Lens::undistort(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d target((pixel.x() - intrinsics_.cx) / intrinsics_.fx,
                               (pixel.y() - intrinsics_.cy) / intrinsics_.fy);
  const auto& k = intrinsics_.distortion;
  return with_lens_model(intrinsics_.lens_model, [&](auto model) -> Eigen::Vector2d {
    if constexpr (decltype(model)::value == LensModel::fisheye) {
      return undistorted_fisheye(k, target, max_radius_squared_);
    } else {
      return undistorted<decltype(model)::value>(k, target);
    }
  });
}

bool Lens::covers_picture() const {
  const double right = intrinsics_.width - 1;
  const double bottom = intrinsics_.height - 1;
  const auto has_ray = [&](double x, double y) {
    const Eigen::Vector2d pixel(x, y);
    const auto back = distort(undistort(pixel));
    return back && (*back - pixel).norm() < 0.5;
  };
  // Of all pixels, one of the corners is farthest from the axis.
  return has_ray(0, 0) && has_ray(right, 0) && has_ray(0, bottom) && has_ray(right, bottom);
}

}  // namespace diminish
