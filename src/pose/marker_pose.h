#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// From this on a pose's alternative is so nearly as good that other evidence settles which of the
/// two it is, where there is some.
inline constexpr double doubtful_ambiguity = 0.2;

/// A marker's pose from its four corners. A square seen in (nearly) weak perspective has two poses
/// that explain its corners almost equally well (Schweighofer & Pinz 2006); both are given.
struct MarkerPose {
  RigidTransform camera_from_marker;
  double error_px = 0;  ///< root mean square reprojection error of the corners
  RigidTransform alternative;
  /// error_px divided by the alternative's error: 0 = certain, near 1 = either may be right.
  double ambiguity = 0;

  bool is_doubtful() const { return ambiguity > doubtful_ambiguity; }
};

/// corners: as in `Marker`, pixels. size_m: side of the black square. Nothing if the corners are
/// no convex quadrilateral in front of the camera. From the plane's homography (Zhang 2000) and its
/// mirror image, Levenberg-Marquardt on the reprojection error.
std::optional<MarkerPose> estimate_marker_pose(const std::array<Eigen::Vector2d, 4>& corners,
                                               double size_m, const Lens& lens);

/// How far a marker at this pose is from where it was seen: root mean square over its corners,
/// pixels; infinite if a corner is out of the lens's view.
double marker_error_px(const RigidTransform& camera_from_marker, double size_m, const Lens& lens,
                       const std::array<Eigen::Vector2d, 4>& corners);

/// The marker's corners in its own frame, in the order of `Marker::corners`.
std::array<Eigen::Vector3d, 4> marker_corners(double size_m);

}  // namespace diminish
