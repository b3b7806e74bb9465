#include "reconstruct/depth_cleaner.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rows.h"
#include "geometry/projection.h"

namespace diminish {
namespace {

/// How far, in depth pixels, from what hides it a pixel must be in the colour image: both are
/// blurred.
constexpr float margin_px = 1;

/// What a depth may be off by, without being between two surfaces.
float noise_m(float depth_m) {
  return 0.008F + 0.004F * depth_m * depth_m;
}

/// The place of the frontmost of what was passed so far.
struct Front {
  float place, depth_m;
};

}  // namespace

DepthCleaner::DepthCleaner(const RgbdCamera& camera)
    : camera_(camera), rays_(Lens(camera.depth).rays()) {}

void DepthCleaner::clean(const Image<std::uint16_t>& depth, const Options& options,
                         Image<std::uint16_t>& cleaned) {
  const auto threshold_m = static_cast<float>(options.discontinuity_threshold_m);
  cleaned.resize(depth.width(), depth.height());
  for_rows(depth.height(), [&](Rows rows) {
    Row& row = rows_[rows.first == 0 ? 0 : 1];
    row.depth_m.resize(static_cast<std::size_t>(depth.width()));
    row.place.resize(static_cast<std::size_t>(depth.width()));
    for (int y = rows.first; y < rows.last; ++y) {
      std::copy_n(depth.row(y), depth.width(), cleaned.row(y));
      if (options.remove_flying) remove_flying(depth, y, cleaned);
      if (options.remove_hidden) remove_hidden(y, threshold_m, row, cleaned);
    }
  });
}

/// Along a row of the depth image the places in the colour image increase, but where something near
/// reaches over what is behind it.
void DepthCleaner::remove_hidden(int y, float threshold_m, Row& row,
                                 Image<std::uint16_t>& cleaned) const {
  const FloatTransform to_color(camera_.color_from_depth);
  const auto unit_m = static_cast<float>(camera_.depth_unit_m);
  std::uint16_t* values = cleaned.row(y);
  const Eigen::Vector2f* rays = rays_.row(y);
  const int width = cleaned.width();
  for (int x = 0; x < width; ++x) {
    const float z = static_cast<float>(values[x]) * unit_m;
    const float inverse = 1 / std::max(z, 1e-3F);
    const float side = to_color.r[0][0] * rays[x].x() + to_color.r[0][1] * rays[x].y() +
                       to_color.r[0][2] + to_color.t[0] * inverse;
    const float ahead = to_color.r[2][0] * rays[x].x() + to_color.r[2][1] * rays[x].y() +
                        to_color.r[2][2] + to_color.t[2] * inverse;
    row.depth_m[static_cast<std::size_t>(x)] = z;
    row.place[static_cast<std::size_t>(x)] = side / std::max(ahead, 1e-3F);
  }
  const auto margin = margin_px / static_cast<float>(camera_.depth.fx);
  constexpr float far_left = -std::numeric_limits<float>::infinity();
  Front front{far_left, 0};
  for (int x = 0; x < width; ++x) {
    const auto i = static_cast<std::size_t>(x);
    if (values[x] == 0) continue;
    if (front.place > row.place[i] - margin && front.depth_m < row.depth_m[i] - threshold_m) {
      values[x] = 0;
    } else if (row.place[i] > front.place) {
      front = {row.place[i], row.depth_m[i]};
    }
  }
  front = {-far_left, 0};
  for (int x = width - 1; x >= 0; --x) {
    const auto i = static_cast<std::size_t>(x);
    if (values[x] == 0) continue;
    if (front.place < row.place[i] + margin && front.depth_m < row.depth_m[i] - threshold_m) {
      values[x] = 0;
    } else if (row.place[i] < front.place) {
      front = {row.place[i], row.depth_m[i]};
    }
  }
}

/// A pixel beside a depth edge stays if it continues the surface on its other side.
void DepthCleaner::remove_flying(const Image<std::uint16_t>& depth, int y,
                                 Image<std::uint16_t>& cleaned) const {
  if (y < 2 || y >= depth.height() - 2) return;
  const auto unit_m = static_cast<float>(camera_.depth_unit_m);
  const std::ptrdiff_t pitch = depth.width();
  const std::uint16_t* row = depth.row(y);
  std::uint16_t* result = cleaned.row(y);
  for (int x = 2; x < depth.width() - 2; ++x) {
    if (row[x] == 0) continue;
    const float z = static_cast<float>(row[x]) * unit_m;
    const float noise = noise_m(z);
    for (const std::ptrdiff_t step : {std::ptrdiff_t{1}, std::ptrdiff_t{-1}, pitch, -pitch}) {
      const auto at = [&](std::ptrdiff_t steps) {
        return static_cast<float>(row[x + steps * step]) * unit_m;
      };
      const float across = at(1);
      if (across > 0 && std::abs(across - z) <= 2.5F * noise) continue;
      const float first = at(-1);
      const float second = at(-2);
      const float continued = second > 0 ? 2 * first - second : first;
      const bool continues = first > 0 && (std::abs(continued - z) <= 2.5F * noise || std::abs(first - z) <= 1.5F * noise);
      if (!continues && across > 0) result[x] = 0;
    }
  }
}

}  // namespace diminish
