#pragma once

#include <Eigen/Core>

namespace diminish {

/// The third component of the cross product: positive if b is clockwise of a, with y down.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace diminish
