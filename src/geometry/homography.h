#pragma once

#include <Eigen/Core>
#include <array>

#include "geometry/cross.h"

namespace diminish {

/// image_from_unit: maps the unit square's corners (0,0), (1,0), (1,1), (0,1) to these four points,
/// no three of which may lie on a line (Heckbert 1989).
inline Eigen::Matrix3d homography_of_unit_square(const std::array<Eigen::Vector2d, 4>& p) {
  const Eigen::Vector2d a = p[1] - p[2];
  const Eigen::Vector2d b = p[3] - p[2];
  const Eigen::Vector2d sum = p[0] - p[1] + p[2] - p[3];
  const double g = cross(sum, b) / cross(a, b);
  const double h = cross(a, sum) / cross(a, b);
  Eigen::Matrix3d homography;
  homography.col(0) << p[1] - p[0] + g * p[1], g;
  homography.col(1) << p[3] - p[0] + h * p[3], h;
  homography.col(2) << p[0], 1;
  return homography;
}

}  // namespace diminish
