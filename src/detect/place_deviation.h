#pragma once

#include <Eigen/Core>
#include <vector>

#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// How uncertain it is where points come to lie in a picture when their place is known by a marker
/// in it: the largest standard deviation of any of them, in any direction, pixels. Uncertain
/// corners make an uncertain pose, the more the smaller the marker, and points far from the marker
/// swing furthest. To first order; infinite if the corners do not determine the pose.
/// corner_deviation_px: of each corner's coordinates. points_m: in the marker's frame.
double place_deviation_px(const RigidTransform& camera_from_marker, double size_m, const Lens& lens,
                          double corner_deviation_px, const std::vector<Eigen::Vector3d>& points_m);

}  // namespace diminish
