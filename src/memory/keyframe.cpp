#include "memory/keyframe.h"

#include <algorithm>

namespace diminish {
namespace {

/// Of the grid.
constexpr int wanted_width = 320;

Intrinsics every(int step, Intrinsics color) {
  color.width = (color.width - 1) / step + 1;
  color.height = (color.height - 1) / step + 1;
  color.fx /= step;
  color.fy /= step;
  color.cx /= step;
  color.cy /= step;
  return color;
}

}  // namespace

std::size_t Keyframe::bytes() const {
  std::size_t bytes =
      picture.size() * sizeof(Bgr) + depth.size() * sizeof(std::uint16_t) + guessed.size();
  for (const Testimony& testimony : testimonies) {
    bytes += testimony.depth_m.size() * (sizeof(float) + sizeof(Bgr));
  }
  return bytes;
}

KeyframeGrid::KeyframeGrid(const Intrinsics& color)
    : color_(color),
      step_(std::max(1, (color.width + wanted_width / 2) / wanted_width)),
      grid_(every(step_, color)),
      rays_(RayTable::of(grid_)) {}

RgbdCamera KeyframeGrid::camera() const {
  RgbdCamera camera;
  camera.name = "memory";
  camera.color = color_;
  camera.depth = grid_;
  camera.depth_unit_m = unit_m;
  return camera;
}

}  // namespace diminish
