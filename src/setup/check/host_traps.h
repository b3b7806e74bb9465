#pragma once

#include <filesystem>
#include <vector>

#include "diminish/rig.h"
#include "diminish/setup_check.h"

namespace diminish {

/// What this machine's kernel and drivers do to live cameras: sockets that hold less than an image,
/// USB buses that carry less than their cameras send, a v4l2loopback that browsers do not see.
/// root: where /proc and /sys are.
std::vector<Finding> host_traps(const Rig& rig, const std::vector<LiveCamera>& cameras,
                                const std::filesystem::path& root = "/");

}  // namespace diminish
