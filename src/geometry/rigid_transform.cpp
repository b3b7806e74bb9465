#include "diminish/rigid_transform.h"

#include <cmath>
#include <numbers>

namespace diminish {

double rotation_difference_deg(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::Quaterniond difference(a.transpose() * b);
  return 2 * std::atan2(difference.vec().norm(), std::abs(difference.w())) * 180 / std::numbers::pi;
}

}  // namespace diminish
