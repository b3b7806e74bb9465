#pragma once

#include <string>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// Where the objects to remove are in every image: the union over all objects.
struct OcclusionMasks {
  Mask color;                    ///< the colour camera
  std::vector<Mask> rgbd_color;  ///< each RGB-D camera's colour sensor
  std::vector<Mask> rgbd_depth;  ///< each RGB-D camera's depth sensor
};

/// A report about one occluder in one frame.
struct OccluderReport {
  std::string name;
  bool in_color = false;      ///< a mask was drawn in the colour image
  std::vector<bool> in_rgbd;  ///< ... in each RGB-D camera
  bool kept = false;          ///< it was not searched for, because the option `keep` names it
  std::string message;        ///< why it was not found, in plain words; empty if it was
};

}  // namespace diminish
