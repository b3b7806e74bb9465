#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// Where a marker is, seen by one camera. A small or distant square has two poses that fit its
/// four corners about equally well.
struct MarkerPose {
  RigidTransform camera_from_marker;
  double error_px;   ///< root mean square of the corners' reprojection errors
  double ambiguity;  ///< best error / second solution's error; near 1 = ambiguous
  RigidTransform alternative;
};

/// The pose of a square of `size_m` from its corners (as in Marker). Nothing when no pose in front
/// of the camera fits.
std::optional<MarkerPose> estimate_marker_pose(const std::array<Eigen::Vector2d, 4>& corners,
                                               double size_m, const Lens& lens);

}  // namespace diminish
