#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "diminish/intrinsics.h"

namespace diminish {

/// The rays (x, y, 1) of a camera's pixels, interpolated between every 32nd pixel's: exact to a few
/// hundredths of a pixel, without the cost of undistorting each one.
class RayGrid {
 public:
  static constexpr int step = 32;  ///< pixels

  explicit RayGrid(const Intrinsics& intrinsics)
      : rays_(intrinsics.width / step + 2, intrinsics.height / step + 2, Eigen::Vector2f::Zero()) {
    const Lens lens(intrinsics);
    for (int row = 0; row < rays_.height(); ++row) {
      for (int column = 0; column < rays_.width(); ++column) {
        rays_(column, row) = lens.undistort({column * step, row * step}).cast<float>();
      }
    }
  }

  /// The exact rays of pixels (column * step, row * step).
  const Image<Eigen::Vector2f>& nodes() const { return rays_; }

  /// Up to `step` pixels of a row from (x, y) on, whose rays are first + i * slope.
  struct Segment {
    int count;
    Eigen::Vector2f first, slope;
  };
  /// end: the column that it must not reach.
  Segment segment(int x, int y, int end) const {
    const int column = x / step;
    const int row = y / step;
    const float below = static_cast<float>(y % step) / step;
    const Eigen::Vector2f left = (1 - below) * rays_(column, row) + below * rays_(column, row + 1);
    const Eigen::Vector2f right =
        (1 - below) * rays_(column + 1, row) + below * rays_(column + 1, row + 1);
    const Eigen::Vector2f slope = (right - left) / step;
    return {std::min(end, (column + 1) * step) - x, left + static_cast<float>(x % step) * slope,
            slope};
  }

 private:
  Image<Eigen::Vector2f> rays_;
};

}  // namespace diminish
