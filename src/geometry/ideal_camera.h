#pragma once

#include <Eigen/Core>

#include "diminish/intrinsics.h"

namespace diminish {

/// A camera without distortion that has a real camera's focal lengths. Its principal point is
/// (0, 0).
class IdealCamera {
 public:
  explicit IdealCamera(const Lens& real) : fx_(real.intrinsics().fx), fy_(real.intrinsics().fy) {}

  /// The pixel of a point in the camera's frame.
  Eigen::Vector2d project(const Eigen::Vector3d& p) const {
    return {fx_ * p.x() / p.z(), fy_ * p.y() / p.z()};
  }
  /// The derivative of the pixel by the point.
  Eigen::Matrix<double, 2, 3> derivative(const Eigen::Vector3d& p) const {
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << fx_ / p.z(), 0, -fx_ * p.x() / (p.z() * p.z()),  //
        0, fy_ / p.z(), -fy_ * p.y() / (p.z() * p.z());
    return by_point;
  }
  /// The pixel in which this camera sees what the real one sees in `pixel`.
  Eigen::Vector2d ideal_pixel(const Lens& real, const Eigen::Vector2d& pixel) const {
    const Eigen::Vector2d ray = real.undistort(pixel);
    return {ray.x() * fx_, ray.y() * fy_};
  }
  /// The x and y of the ray (x, y, 1) through a pixel of this camera.
  Eigen::Vector2d ray(const Eigen::Vector2d& ideal_pixel) const {
    return {ideal_pixel.x() / fx_, ideal_pixel.y() / fy_};
  }

 private:
  double fx_, fy_;
};

}  // namespace diminish
