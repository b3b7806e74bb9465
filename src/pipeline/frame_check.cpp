#include "pipeline/frame_check.h"

#include <fmt/format.h>

#include <string>

#include "diminish/error.h"

namespace diminish {
namespace {

template <class Pixel>
void expect_size(const Image<Pixel>& image, const Intrinsics& intrinsics, const std::string& name) {
  if (image.width() != intrinsics.width || image.height() != intrinsics.height) {
    throw Error(Error::input,
                fmt::format("{}: expected an image of {}x{}, got {}x{}", name, intrinsics.width,
                            intrinsics.height, image.width(), image.height()));
  }
}

}  // namespace

void expect_sizes(const FrameSet& frame, const Rig& rig) {
  if (!frame.color.empty()) expect_size(frame.color, rig.color, "color");
  if (frame.rgbd.size() != rig.rgbd.size()) {
    throw Error(Error::input, fmt::format("frame: expected {} RGB-D cameras, got {}",
                                          rig.rgbd.size(), frame.rgbd.size()));
  }
  for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
    if (!frame.rgbd[k].available()) continue;
    expect_size(frame.rgbd[k].color, rig.rgbd[k].color, color_sensor_name(rig.rgbd[k]));
    expect_size(frame.rgbd[k].depth, rig.rgbd[k].depth, rig.rgbd[k].name + " depth");
  }
}

}  // namespace diminish
