#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "diminish/poses.h"
#include "diminish/rig.h"

namespace diminish {

/// A recording's exact poses (truth/poses.json).
class TruthPoses {
 public:
  explicit TruthPoses(const std::filesystem::path& recording) {
    std::ifstream(recording / "truth" / "poses.json") >> frames_;
  }

  std::size_t size() const { return frames_.size(); }
  std::string frame(std::size_t index) const { return frames_[index]["frame"]; }
  RigidTransform world_from_occluder(std::size_t index, const std::string& name) const {
    return read(frames_[index]["occluders"][name]);
  }

  /// All of the rig's poses.
  Poses poses(std::size_t index, const Rig& rig) const {
    Poses poses;
    poses.color_from_world = read(frames_[index]["color_from_world"]);
    for (const RgbdCamera& camera : rig.rgbd) {
      poses.depth_from_world.emplace_back(read(frames_[index][camera.name + "_depth_from_world"]));
      poses.color_from_depth.emplace_back(*poses.color_from_world *
                                          poses.depth_from_world.back()->inverse());
    }
    return poses;
  }

 private:
  static RigidTransform read(const nlohmann::json& rows) {
    RigidTransform transform;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        transform.rotation(row, column) = rows[row][column];
      transform.translation[row] = rows[row][3];
    }
    return transform;
  }

  nlohmann::json frames_;
};

}  // namespace diminish
