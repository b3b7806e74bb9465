#pragma once

#include <algorithm>
#include <string_view>

#include "diminish/rig.h"

namespace diminish {

/// The rig's RGB-D camera of this name; nullptr if it has none.
inline const RgbdCamera* find_rgbd_camera(const Rig& rig, std::string_view name) {
  const auto found = std::find_if(rig.rgbd.begin(), rig.rgbd.end(),
                                  [&](const RgbdCamera& camera) { return camera.name == name; });
  return found == rig.rgbd.end() ? nullptr : &*found;
}

}  // namespace diminish
