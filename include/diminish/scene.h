#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "diminish/config.h"

namespace diminish {

/// A square fiducial. Its frame: origin at the centre, x right, y up, z out of the marker.
struct MarkerSpec {
  int id = 0;
  double size_m = 0;  ///< side of the black square
};

/// An object to remove: which detector finds it, and that detector's own settings.
struct OccluderSpec {
  std::string name;
  std::string detector;
  Config config;
};

/// What is in front of the cameras: a recording's `scene.yaml`.
struct Scene {
  std::string marker_dictionary;
  MarkerSpec world_marker;
  std::vector<OccluderSpec> occluders;
};

/// Reads `scene.yaml`. Throws Error, naming file and key.
Scene load_scene(const std::filesystem::path& file);

/// Reads `{id: .., size_m: ..}`.
MarkerSpec read_marker(const Config& config);

}  // namespace diminish
