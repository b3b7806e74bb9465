#pragma once

#include <algorithm>

#include "diminish/intrinsics.h"

namespace diminish {

/// The camera of a picture whose pixels are the means of `by` x `by` of the camera's. Columns and
/// rows that are left over at the right and below are cut off.
inline Intrinsics shrunk_camera(Intrinsics camera, int by) {
  camera.width = std::max(1, camera.width / by);
  camera.height = std::max(1, camera.height / by);
  camera.fx /= by;
  camera.fy /= by;
  camera.cx = (camera.cx + 0.5) / by - 0.5;
  camera.cy = (camera.cy + 0.5) / by - 0.5;
  return camera;
}

}  // namespace diminish
