#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "diminish/export.h"
#include "diminish/scene.h"

namespace diminish {

/// For the detector `marker`: an object with a marker on it, whose shape in the marker's frame is
/// known.
class DIMINISH_EXPORT MarkerSettings : public OccluderSettings {
 public:
  MarkerSpec marker;
  /// At least 4, in metres. Without triangles, the shape is their convex hull.
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;  ///< indices of vertices
  /// A Wavefront OBJ file with the shape instead; empty: none.
  std::filesystem::path mesh;

  void check(const Config& place, const Rig* rig) const override;
  std::optional<MarkerSpec> marker_on_it() const override { return marker; }
  std::vector<std::filesystem::path> files() const override;
};

/// For the detector `color_blob`: an object that is found by its colour.
class DIMINISH_EXPORT ColorBlobSettings : public OccluderSettings {
 public:
  enum class Shape { any, circle };

  std::filesystem::path training;  ///< the folder with the training images
  Shape shape = Shape::any;

  void check(const Config& place, const Rig* rig) const override;
  std::vector<std::filesystem::path> files() const override { return {training}; }
};

/// For the detector `mask`: an object whose masks another program makes. Frames contain them
/// (FrameSet::masks); a recording's are read from folders.
class DIMINISH_EXPORT MaskSettings : public OccluderSettings {
 public:
  std::filesystem::path color;                        ///< the colour camera's masks
  std::map<std::string, std::filesystem::path> rgbd;  ///< by RGB-D camera; may be left out

  void check(const Config& place, const Rig* rig) const override;
};

/// For the detector `box`: whatever the RGB-D cameras see inside a box.
class DIMINISH_EXPORT BoxSettings : public OccluderSettings {
 public:
  std::string frame = "world";  ///< or an RGB-D camera's name, for its depth sensor's frame
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero(), max_m = Eigen::Vector3d::Zero();

  void check(const Config& place, const Rig* rig) const override;
  bool needs_world() const override { return frame == "world"; }
};

/// For the detector `difference`: whatever stands free in front of what the RGB-D cameras see.
class DIMINISH_EXPORT DifferenceSettings : public OccluderSettings {
 public:
  /// Of the distance from the colour camera to what an object hides: the share that is at least
  /// between the two, somewhere. What stands closer to its background is part of the scene.
  double clearance = 0.3;

  void check(const Config& place, const Rig* rig) const override;
};

}  // namespace diminish
