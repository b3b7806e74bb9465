#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace diminish {

/// A camera-node that publishes a recording's rgbd0 at /rgbd0, over and over. parameters:
/// "?keys=...".
inline std::vector<std::string> camera_node_arguments(const std::filesystem::path& recording,
                                                      const std::string& parameters = "") {
  return {"camera-node", "recording:" + recording.string() + "?loop",
          "--topic",     "/rgbd0" + parameters,
          "--name",      "rgbd0",
          "--rig",       recording.string()};
}

}  // namespace diminish
