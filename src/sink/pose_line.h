#pragma once

#include <fmt/format.h>

#include <string>

#include "diminish/rigid_transform.h"

namespace diminish {

/// Above a list of poses.
inline constexpr const char* pose_list_head =
    "# timestamp tx ty tz qx qy qz qw: world_from_camera\n";

/// A line of a TUM list: world_from_camera.
inline std::string pose_line(double stamp_s, const RigidTransform& camera_from_world) {
  const RigidTransform world_from_camera = camera_from_world.inverse();
  const Eigen::Quaterniond q(world_from_camera.rotation);
  const Eigen::Vector3d& t = world_from_camera.translation;
  return fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", stamp_s, t.x(),
                     t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

}  // namespace diminish
