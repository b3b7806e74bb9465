#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "diminish/config.h"
#include "diminish/export.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

struct Rig;

/// A depth sensor with a colour sensor rigidly beside it; or a colour camera whose depth image is
/// estimated.
struct RgbdCamera {
  std::string name;
  Intrinsics color;
  /// Of an estimated depth image: the colour sensor's without lens distortion, made smaller.
  Intrinsics depth;
  /// Metres = depth value * depth_unit_m; value 0 = no measurement.
  double depth_unit_m = 0.001;
  /// From this camera's depth sensor to its own colour sensor.
  RigidTransform color_from_depth;
  /// False: a colour camera. Its pictures come without depth, which is estimated (DepthEstimator).
  bool measures_depth = true;
  /// Where an estimate looks for surfaces, metres.
  double nearest_m = 0.4, farthest_m = 6;
  /// From the frame of which poses are given (pose.source fixed, file) to the depth image's.
  RigidTransform depth_from_posed = {};
};

/// A colour camera without depth.
DIMINISH_EXPORT RgbdCamera color_only_camera(const std::string& name, const Intrinsics& color);
/// The rig, as if none of its cameras measured depth.
DIMINISH_EXPORT Rig without_depth(Rig rig);

/// A camera of a live session. An RGB-D camera with two devices has two.
struct LiveCamera {
  std::string name;  ///< "color", or an RGB-D camera's name in the rig
  std::string uri;
};

/// The cameras and the source of their poses: a recording's `rig.yaml`. "The colour camera" is
/// always the user's view; an RGB-D camera's colour sensor is called that.
struct Rig {
  Intrinsics color;
  std::vector<RgbdCamera> rgbd;
  /// The name of a registered `PoseSource`, and its own settings (the file's `pose` key).
  std::string pose_source = "marker";
  Config pose;
  /// Where live cameras are found, if the set-up says so; the user's view first.
  std::vector<LiveCamera> live = {};
};

/// Reads `rig.yaml`. Throws Error that names file and key.
DIMINISH_EXPORT Rig load_rig(const std::filesystem::path& file);
/// The same for a file that has already been read.
DIMINISH_EXPORT Rig read_rig(const Config& config);

/// The name of an RGB-D camera's colour sensor in messages: "rgbd0 color".
inline std::string color_sensor_name(const RgbdCamera& camera) {
  return camera.name + " color";
}

}  // namespace diminish
