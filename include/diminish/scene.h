#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diminish/config.h"
#include "diminish/export.h"

namespace diminish {

struct Rig;

/// A square fiducial. Its frame: origin at the centre, x right, y up, z out of the marker.
struct MarkerSpec {
  int id = 0;
  double size_m = 0;  ///< side of the black square
};

/// A detector's settings for its object. Each detector has its own type (occluder_settings.h).
class DIMINISH_EXPORT OccluderSettings {
 public:
  virtual ~OccluderSettings() = default;

  /// Throws Error on settings that cannot work, through `place.find(KEY).fail(..)`. place: the
  /// occluder's place in a file. rig: null if unknown.
  virtual void check(const Config& /*place*/, const Rig* /*rig*/) const {}
  /// The marker on the object, if there is one.
  virtual std::optional<MarkerSpec> marker_on_it() const { return std::nullopt; }
  /// Whether the world's pose is needed to find the object.
  virtual bool needs_world() const { return false; }
  /// The files and folders that a copy of the scene needs.
  virtual std::vector<std::filesystem::path> files() const { return {}; }
};

/// An object to remove.
struct OccluderSpec {
  std::string name;
  std::string detector;  ///< the name of a registered `OccluderDetector`
  std::shared_ptr<const OccluderSettings> settings;  ///< of the detector's own type
  Config place = {};  ///< where it was read, for messages; empty if it was not
};

/// A flat part of the background. Where a camera measures no depth, it may be all that is known.
struct GivenPlane {
  enum class From : std::uint8_t {
    world,    ///< `point` and `normal`, as far as `corners` reach
    marker,   ///< a marker lies on it
    features  ///< found in the pictures: up to `count` planes that hold what both cameras see
  } from = From::world;
  /// World frame, metres.
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  /// Of a convex part, in order; none: it has no end.
  std::vector<Eigen::Vector3d> corners = {};
  MarkerSpec marker = {};
  int count = 1;
};

/// What is in front of the cameras: a recording's `scene.yaml`.
struct Scene {
  std::string marker_dictionary = "DICT_4X4_50";
  MarkerSpec world_marker;  ///< size 0: none
  std::vector<OccluderSpec> occluders;
  std::vector<GivenPlane> planes = {};
};

/// Reads `scene.yaml`. Throws Error that names file and key.
DIMINISH_EXPORT Scene load_scene(const std::filesystem::path& file);
/// The same for a file that has already been read.
DIMINISH_EXPORT Scene read_scene(const Config& config);

/// Reads `{id: .., size_m: ..}`.
DIMINISH_EXPORT MarkerSpec read_marker(const Config& config);

}  // namespace diminish
