#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// One camera, and a marker's corners in its picture (as in Marker) if it sees the marker.
struct MarkerView {
  const Lens* lens = nullptr;
  std::optional<std::array<Eigen::Vector2d, 4>> corners;
  /// The transform to a frame that all views share; absent if the camera's pose is unknown.
  std::optional<RigidTransform> common_from_camera;
};

/// Fills camera_from_marker of each view. Uses the view's own corners if it has any; of two poses
/// that fit them about equally well, takes the one that agrees with the other views. Otherwise uses
/// the view in which the marker is largest. Absent if neither is possible.
void locate_marker(const std::vector<MarkerView>& views, double size_m,
                   std::vector<std::optional<RigidTransform>>& camera_from_marker);

}  // namespace diminish
