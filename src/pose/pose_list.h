#pragma once

#include <filesystem>
#include <istream>
#include <vector>

#include "diminish/rigid_transform.h"

namespace diminish {

/// A camera's pose at a moment.
struct StampedPose {
  double stamp_s = 0;
  RigidTransform world_from_camera;
};

/// Reads a trajectory as the TUM RGB-D benchmark writes it: "timestamp tx ty tz qx qy qz qw" per
/// line, '#' starts a comment, timestamps ascending. Throws Error with file and line.
std::vector<StampedPose> load_pose_list(const std::filesystem::path& file);
std::vector<StampedPose> read_pose_list(std::istream& stream, const std::filesystem::path& file);

/// The pose nearest in time to `stamp_s`; null if none is within `tolerance_s`.
const StampedPose* find_nearest(const std::vector<StampedPose>& poses, double stamp_s,
                                double tolerance_s);

}  // namespace diminish
