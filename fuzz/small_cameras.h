#pragma once

#include <algorithm>

#include "diminish/rig.h"

namespace diminish {

/// Whether frames of these cameras take a fuzzer milliseconds.
inline bool has_small_cameras(const Rig& rig) {
  constexpr int most_pixels = 64 * 64;
  const auto is_small = [](const Intrinsics& camera) {
    return camera.width * camera.height <= most_pixels;
  };
  return is_small(rig.color) && rig.rgbd.size() <= 4 &&
         std::all_of(rig.rgbd.begin(), rig.rgbd.end(), [&](const RgbdCamera& camera) {
           return is_small(camera.color) && (!camera.measures_depth || is_small(camera.depth));
         });
}

}  // namespace diminish
