#include "memory/testimony.h"

#include <algorithm>
#include <cmath>

#include "core/channels.h"
#include "core/rows.h"
#include "memory/keyframe.h"

namespace diminish {
namespace {

/// Of 3x3 pixels.
Bgr mean_color(ImageView<Bgr> image, const Pixel& pixel) {
  int sum[3] = {};
  for (int row = pixel.y - 1; row <= pixel.y + 1; ++row) {
    for (int column = pixel.x - 1; column <= pixel.x + 1; ++column) {
      const Bgr& color = image(column, row);
      sum[0] += color.b;
      sum[1] += color.g;
      sum[2] += color.r;
    }
  }
  const auto mean = [&](int c) { return static_cast<std::uint8_t>(sum[c] / 9); };
  return {mean(0), mean(1), mean(2)};
}

}  // namespace

TestimonyTaker::TestimonyTaker(const RgbdCamera& camera)
    : camera_(camera),
      rays_(RayTable::of(camera.depth)),
      depth_(Lens(camera.depth)),
      color_(Lens(camera.color)),
      color_from_depth_(camera.color_from_depth) {}

void TestimonyTaker::take(const RgbdFrame& images,
                          const std::optional<RigidTransform>& depth_from_world,
                          const Mask& depth_mask, const Mask& color_mask,
                          Testimony& testimony) const {
  testimony.is_given = images.available() && depth_from_world;
  if (!testimony.is_given) return;
  testimony.depth_from_world = *depth_from_world;
  const int width = grid().width;
  const int height = grid().height;
  testimony.depth_m.resize(width, height);
  testimony.color.resize(width, height);
  const auto unit_m = static_cast<float>(camera_.depth_unit_m);
  const ImageView<std::uint16_t> depth = images.depth;
  const ImageView<Bgr> color = images.color;
  const Rect inside = grow(color.bounds(), -1);
  for_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < width; ++x) {
        const int column = x * Testimony::step;
        const int row = y * Testimony::step;
        float& depth_m = testimony.depth_m(x, y);
        depth_m = 0;
        const float z = static_cast<float>(depth(column, row)) * unit_m;
        if (depth_mask(column, row) != 0 || !(z > 0)) continue;
        const Eigen::Vector3f point = point_m(x, y, z);
        const auto pixel = project(color_, transform(color_from_depth_, point));
        if (!pixel || !inside.contains(pixel->x, pixel->y) || color_mask(pixel->x, pixel->y) != 0) {
          continue;
        }
        depth_m = z;
        testimony.color(x, y) = mean_color(color, *pixel);
      }
    }
  });
}

}  // namespace diminish
