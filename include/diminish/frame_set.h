#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "diminish/image.h"
#include "diminish/input_image.h"

namespace diminish {

class RemoteImages;

/// One RGB-D camera's images at one moment.
struct RgbdFrame {
  InputImage<Bgr> color;
  InputImage<std::uint16_t> depth;
  double color_stamp_s = 0;
  double depth_stamp_s = 0;
  /// Why there are no images, in plain words; empty if all that the camera makes are there.
  std::string missing;
  /// Where the images are on another machine: what that one tells of them. Then `color` is empty,
  /// and `depth` a view of the glance's.
  std::shared_ptr<RemoteImages> remote;

  bool has_picture() const { return missing.empty() && !color.empty(); }
  bool available() const { return has_picture() && !depth.empty(); }
  bool is_remote() const { return missing.empty() && remote != nullptr; }
  /// Whether its depth can be drawn, here or elsewhere.
  bool takes_part() const { return available() || is_remote(); }
};

/// Masks of one occluder, made by another program: 255 on the object. An image without a mask is
/// empty.
struct GivenMask {
  std::string occluder;
  Mask color;              ///< in the colour camera
  std::vector<Mask> rgbd;  ///< in each RGB-D camera's colour sensor
};

/// Everything that the cameras saw at one moment: the pipeline's input.
struct FrameSet {
  std::string name;       ///< the colour image's file stem
  std::size_t index = 0;  ///< 0 for the first frame
  double stamp_s = 0;
  InputImage<Bgr> color;        ///< empty if it could not be read; the frame is then skipped
  std::vector<RgbdFrame> rgbd;  ///< one per RGB-D camera of the rig, in its order
  std::vector<GivenMask> masks;
  /// Images that could not be used, each with its file and the reason.
  std::vector<std::string> faults;
};

}  // namespace diminish
