#include "memory/testimony.h"

#include "core/rows.h"
#include "geometry/every.h"
#include "geometry/point_rows.h"

namespace diminish {
namespace {

/// Of a testimony: coarse, so that it costs little. Fine things are seen by their colours.
constexpr int wanted_columns = 160;

/// Of 3x3 pixels.
Bgr mean_color(ImageView<Bgr> image, int x, int y) {
  int sum[3] = {};
  for (int row = y - 1; row <= y + 1; ++row) {
    const Bgr* const pixels = image.row(row) + x - 1;
    for (int i = 0; i < 3; ++i) {
      sum[0] += pixels[i].b;
      sum[1] += pixels[i].g;
      sum[2] += pixels[i].r;
    }
  }
  const auto mean = [&](int c) { return static_cast<std::uint8_t>(sum[c] / 9); };
  return {mean(0), mean(1), mean(2)};
}

}  // namespace

TestimonyGrid::TestimonyGrid(const Intrinsics& depth)
    : step_(std::max(1, (depth.width + wanted_columns / 2) / wanted_columns)),
      bounds_(every(step_, depth).bounds()),
      lens_(Lens(every(step_, depth))),
      rays_(RayTable::of(every(step_, depth))) {}

TestimonyTaker::TestimonyTaker(const RgbdCamera& camera)
    : grid_(camera.depth),
      unit_m_(static_cast<float>(camera.depth_unit_m)),
      color_(Lens(camera.color)),
      color_from_depth_(camera.color_from_depth) {}

void TestimonyTaker::take(const RgbdFrame& images,
                          const std::optional<RigidTransform>& depth_from_world,
                          const Mask& depth_mask, const Mask& color_mask,
                          Testimony& testimony) const {
  testimony.is_given = images.available() && depth_from_world;
  if (!testimony.is_given) return;
  testimony.depth_from_world = *depth_from_world;
  const int width = grid_.bounds().width;
  const int height = grid_.bounds().height;
  testimony.depth_m.resize(width, height);
  testimony.color.resize(width, height);
  const ImageView<std::uint16_t> depth = images.depth;
  const ImageView<Bgr> color = images.color;
  const PointView view{color_from_depth_, color_, grow(color.bounds(), -1), color.width()};
  for_rows(height, [&](Rows rows) {
    std::int32_t pixels[TestimonyGrid::most_columns];
    float unused[TestimonyGrid::most_columns];
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint16_t* const measured = depth.row(y * grid_.step());
      const std::uint8_t* const masked = depth_mask.row(y * grid_.step());
      float* const depth_m = testimony.depth_m.row(y);
      for (int x = 0; x < width; ++x) {
        const int column = x * grid_.step();
        depth_m[x] = masked[column] == 0 ? static_cast<float>(measured[column]) * unit_m_ : 0;
      }
      find_pixels({grid_.rays().x(y), grid_.rays().y(y), depth_m, width}, view, pixels, unused);
      for (int x = 0; x < width; ++x) {
        if (pixels[x] < 0 || color_mask.data()[pixels[x]] != 0) {
          depth_m[x] = 0;
          continue;
        }
        const int row = pixels[x] / color.width();
        testimony.color(x, y) = mean_color(color, pixels[x] - row * color.width(), row);
      }
    }
  });
}

}  // namespace diminish
