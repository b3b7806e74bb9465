#include "pipeline/frame_check.h"

#include <fmt/format.h>

#include <string>

#include "diminish/error.h"

namespace diminish {
namespace {

template <class Pixel>
void expect_size(const ImageView<Pixel>& image, const Intrinsics& intrinsics,
                 const std::string& name) {
  if (image.width() != intrinsics.width || image.height() != intrinsics.height) {
    throw Error(Error::input,
                fmt::format("{}: expected an image of {}x{}, got {}x{}", name, intrinsics.width,
                            intrinsics.height, image.width(), image.height()));
  }
  const auto row = image.width() * std::ptrdiff_t{sizeof(Pixel)};
  if (image.stride() < row || image.stride() % std::ptrdiff_t{alignof(Pixel)} != 0) {
    throw Error(Error::input,
                fmt::format("{}: expected a stride of at least {} bytes, a multiple of {}, got {}",
                            name, row, alignof(Pixel), image.stride()));
  }
}

}  // namespace

void expect_sizes(const FrameSet& frame, const Rig& rig) {
  if (!frame.color.empty()) expect_size(frame.color.view(), rig.color, "color");
  if (frame.rgbd.size() != rig.rgbd.size()) {
    throw Error(Error::input, fmt::format("frame: expected {} RGB-D cameras, got {}",
                                          rig.rgbd.size(), frame.rgbd.size()));
  }
  for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
    const RgbdFrame& rgbd = frame.rgbd[k];
    const bool measures = rig.rgbd[k].measures_depth;
    if (!rgbd.has_picture() || (measures && rgbd.depth.empty())) continue;
    expect_size(rgbd.color.view(), rig.rgbd[k].color, color_sensor_name(rig.rgbd[k]));
    if (measures) expect_size(rgbd.depth.view(), rig.rgbd[k].depth, rig.rgbd[k].name + " depth");
  }
}

}  // namespace diminish
