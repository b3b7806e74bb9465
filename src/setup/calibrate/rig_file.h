#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// A rig.yaml that is filled step by step: what is not set stays as it is, comments included. It
/// may lack what has not been calibrated yet.
class RigFile {
 public:
  /// If there is no such file, it begins as `start`; empty if that is not there either. Throws
  /// Error if it is no YAML.
  explicit RigFile(std::filesystem::path file, const std::filesystem::path& start = {});

  /// camera: "color", or an RGB-D camera's sensor, such as "rgbd0_color" or "rgbd0_depth".
  void set_intrinsics(const std::string& camera, const Intrinsics& intrinsics);
  /// rgbd: an RGB-D camera's name.
  void set_color_from_depth(const std::string& rgbd, const RigidTransform& color_from_depth);
  /// Sets `pose` to source fixed: an RGB-D camera's name with the transform from its depth frame to
  /// the colour camera's.
  void set_fixed_poses(const std::vector<std::pair<std::string, RigidTransform>>& color_from_rgbd);

  const std::string& text() const { return text_; }
  /// Replaces the file, whole or not at all.
  void write() const;

 private:
  std::filesystem::path file_;
  std::string text_;
};

/// Throws Error unless `camera` is a name that `set_intrinsics` takes.
void expect_camera_name(const std::string& camera);

}  // namespace diminish
