#include "memory/keyframe.h"

#include <algorithm>

#include "geometry/every.h"

namespace diminish {
namespace {

/// Of the grid.
constexpr int wanted_width = 320;

}  // namespace

std::size_t Keyframe::bytes() const {
  std::size_t bytes = picture.size() * sizeof(Bgr) + depth.size() * sizeof(std::uint16_t) +
                      doubt.size() + confirmed_s.size() * sizeof(float);
  for (const Testimony& testimony : testimonies) {
    bytes += testimony.depth_m.size() * (sizeof(float) + sizeof(Bgr));
  }
  for (const Image<Sight>& of_camera : sights) bytes += of_camera.size() * sizeof(Sight);
  bytes += overview_m.size() * sizeof(float) + samples.size() * sizeof(SceneSample);
  return bytes;
}

KeyframeGrid::KeyframeGrid(const Intrinsics& color)
    : color_(color),
      step_(std::max(1, (color.width + wanted_width / 2) / wanted_width)),
      grid_(every(step_, color)),
      lens_(Lens(grid_)),
      rays_(RayTable::of(grid_)),
      overview_rays_(RayTable::of(every(overview_step, grid_))) {}

RgbdCamera KeyframeGrid::camera() const {
  RgbdCamera camera;
  camera.name = "memory";
  camera.color = color_;
  camera.depth = grid_;
  camera.depth_unit_m = unit_m;
  return camera;
}

void KeyframeGrid::sample(ImageView<Bgr> picture, Image<Bgr>& colors) const {
  colors.resize(grid_.width, grid_.height);
  for (int y = 0; y < grid_.height; ++y) {
    for (int x = 0; x < grid_.width; ++x) colors(x, y) = picture(x * step_, y * step_);
  }
}

}  // namespace diminish
