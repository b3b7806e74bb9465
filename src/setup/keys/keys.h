#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace diminish {

/// Keys to make for DDS Security (ROS 2's wire).
struct KeysRequest {
  std::vector<std::string> names;  ///< of participants: "camera_host", also "lab/camera_host"
  /// Topics that they may use, "/rgbd0/*"; both empty: all.
  std::vector<std::string> publish, subscribe;
  int days = 3650;  ///< that they are good for
  std::chrono::system_clock::time_point now = std::chrono::system_clock::now();
};

struct KeysMade {
  bool is_new_authority = false;
  std::vector<std::filesystem::path> folders;  ///< one for each name: what keys= takes
};

/// Makes a key, a certificate and signed permissions for each name, below `folder`/enclaves. The
/// folder has the layout of SROS2's keystores: one of theirs is extended, and a new one gets its
/// own certificate authority. Private keys are readable for their owner only. Throws Error that
/// names the file or the name, and what was expected.
KeysMade make_keys(const std::filesystem::path& folder, const KeysRequest& request);

}  // namespace diminish
