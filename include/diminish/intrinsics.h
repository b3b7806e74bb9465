#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "diminish/image.h"

namespace diminish {

/// A camera's pinhole and lens: OpenCV's plumb-bob model on images as the sensor made them.
/// Camera frame: x right, y down, z forward. Pixel centres at integer coordinates.
struct Intrinsics {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  /// [k1, k2, p1, p2, k3]
  std::array<double, 5> distortion{};

  Rect bounds() const { return {0, 0, width, height}; }
};

/// Projection with `Intrinsics`, with what can be computed once kept.
class Lens {
 public:
  Lens() = default;
  explicit Lens(const Intrinsics& intrinsics);

  const Intrinsics& intrinsics() const { return intrinsics_; }

  /// The pixel of a point in the camera frame. Nothing for a point behind the camera or so far
  /// off the axis that the distortion polynomial folds back.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& x_in_camera) const;

  /// The pixel of the ray (x, y, 1); nothing beyond the polynomial's valid radius.
  std::optional<Eigen::Vector2d> distort(const Eigen::Vector2d& ray) const;

  /// The ray (x, y, 1) of a pixel: the inverse of `distort`, by Newton's method, to 1e-9.
  Eigen::Vector2d undistort(const Eigen::Vector2d& pixel) const;

  /// The squared radius |(x, y)| of a ray from which on the distortion polynomial folds back.
  double max_radius_squared() const { return max_radius_squared_; }

  /// The ray of every pixel, row by row.
  Image<Eigen::Vector2f> rays() const;

 private:
  Intrinsics intrinsics_;
  double max_radius_squared_ = 0;
};

}  // namespace diminish
