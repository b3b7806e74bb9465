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
};

/// Opens a camera and waits for images, for a few seconds at most. name: "color" or an RGB-D
/// camera's. Throws Error that names the URI if it delivers none.
DIMINISH_EXPORT FoundCamera look_at_camera(const std::string& uri, const std::string& name);

/// A rig.yaml, with comments that say what was guessed. color: the user's view. rgbd: delivers
/// color and depth; one camera for each, or two of the same name, one for each sensor.
struct InitialRig {
  FoundCamera color;
  struct Rgbd {
    std::string name;
    std::vector<FoundCamera> devices;
  };
  std::vector<Rgbd> rgbd;
};
/// Throws Error where an RGB-D camera lacks a sensor.
DIMINISH_EXPORT std::string initial_rig_yaml(const InitialRig& rig);

/// A scene.yaml that removes whatever stands free, with comments. marker_size_m: of the world
/// marker.
DIMINISH_EXPORT std::string initial_scene_yaml(double marker_size_m);

}  // namespace diminish
