#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diminish/export.h"
#include "diminish/intrinsics.h"
#include "diminish/live.h"

namespace diminish {

/// What a camera's first images and its driver tell.
struct FoundCamera {
  std::string uri;
  /// Of the sensors that deliver images. Where the driver does not know them, a guess from the
  /// image's size.
  std::optional<Intrinsics> color, depth;
  bool color_is_guess = false, depth_is_guess = false;
  /// As the driver tells it.
  std::optional<RigidTransform> color_from_depth;
};

/// Opens a camera and waits for images, for a few seconds at most. name: "color" or an RGB-D
/// camera's. Throws Error that names the URI if it delivers none.
DIMINISH_EXPORT FoundCamera look_at_camera(const std::string& uri, const std::string& name);

/// The cameras that a set-up begins with. color: the user's view. rgbd: delivers color and depth;
/// one camera for each, or two of the same name, one for each sensor. color_only: cameras beside
/// the user's that deliver no depth.
struct InitialRig {
  struct Named {
    std::string name;
    std::vector<FoundCamera> devices;
  };
  FoundCamera color;
  std::vector<Named> rgbd, color_only;
};
/// A rig.yaml, with comments that say what was guessed. Throws Error where a camera lacks a sensor.
DIMINISH_EXPORT std::string initial_rig_yaml(const InitialRig& rig);

/// The marker on the object where nothing measures depth.
constexpr int initial_object_marker = 1;
constexpr double initial_object_marker_m = 0.08;

/// A scene.yaml, with comments. It removes whatever stands free or, where nothing measures depth,
/// what carries a marker. marker_size_m: of the world marker.
DIMINISH_EXPORT std::string initial_scene_yaml(const InitialRig& rig, double marker_size_m);

}  // namespace diminish
