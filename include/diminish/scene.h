#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "diminish/config.h"
#include "diminish/export.h"

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
  std::string marker_dictionary = "DICT_4X4_50";
  MarkerSpec world_marker;  ///< of size 0: there is none
  std::vector<OccluderSpec> occluders;
};

/// Reads `scene.yaml`. Throws Error, naming file and key.
DIMINISH_EXPORT Scene load_scene(const std::filesystem::path& file);
/// The same for a file that has been read already.
DIMINISH_EXPORT Scene read_scene(const Config& config);

/// Reads `{id: .., size_m: ..}`.
DIMINISH_EXPORT MarkerSpec read_marker(const Config& config);

}  // namespace diminish
