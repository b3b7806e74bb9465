#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// A rig.yaml that is filled step by step. Everything that is not set stays as it is, including
/// comments. It may lack what has not been calibrated yet.
class RigFile {
 public:
  /// If the file does not exist, it starts as a copy of `start`, or empty if that does not exist
  /// either. Throws Error if it is not YAML.
  explicit RigFile(std::filesystem::path file, const std::filesystem::path& start = {});

  /// camera: "color", or an RGB-D camera's sensor, such as "rgbd0_color" or "rgbd0_depth".
  void set_intrinsics(const std::string& camera, const Intrinsics& intrinsics);
  /// rgbd: an RGB-D camera's name.
  void set_color_from_depth(const std::string& rgbd, const RigidTransform& color_from_depth);
  /// Sets `pose` to source fixed, with each RGB-D camera's name and the transform from its depth
  /// frame to the colour camera's.
  void set_fixed_poses(const std::vector<std::pair<std::string, RigidTransform>>& color_from_rgbd);

  const std::string& text() const { return text_; }
  /// Replaces the file, completely or not at all.
  void write() const;

 private:
  std::filesystem::path file_;
  std::string text_;
};

/// Throws Error unless `set_intrinsics` accepts the name `camera`.
void expect_camera_name(const std::string& camera);

}  // namespace diminish
