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

/// Pixels on both sides that are averaged.
constexpr int smoothing_reach = 2;

/// What a depth may be off by, without being between two surfaces.
float noise_m(float depth_m) {
  return 0.008F + 0.004F * depth_m * depth_m;
}

/// The frontmost of what was passed so far: its place in the colour image, and its depth.
struct Front {
  float place, depth_m;
};

}  // namespace

DepthCleaner::DepthCleaner(const RgbdCamera& camera) : camera_(camera) {
  const Image<Eigen::Vector2f> rays = Lens(camera.depth).rays();
  ray_side_.resize(rays.width(), rays.height());
  ray_ahead_.resize(rays.width(), rays.height());
  const FloatTransform to_color(camera.color_from_depth);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const float x = rays.data()[i].x();
    const float y = rays.data()[i].y();
    ray_side_.data()[i] = to_color.r[0][0] * x + to_color.r[0][1] * y + to_color.r[0][2];
    ray_ahead_.data()[i] = to_color.r[2][0] * x + to_color.r[2][1] * y + to_color.r[2][2];
  }
}

void DepthCleaner::clean(const Image<std::uint16_t>& depth, const Rect& part,
                         const Options& options, Image<std::uint16_t>& cleaned) {
  const auto threshold_m = static_cast<float>(options.discontinuity_threshold_m);
  cleaned = depth;
  for_rows(part.height, [&](Rows rows) {
    Row& row = rows_[rows.first == 0 ? 0 : 1];
    row.depth_m.resize(static_cast<std::size_t>(depth.width()));
    row.place.resize(static_cast<std::size_t>(depth.width()));
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      if (options.remove_flying) remove_flying(depth, part, y, cleaned);
      if (options.remove_hidden) remove_hidden(part, y, threshold_m, row, cleaned);
    }
  });
  if (options.smooth_depth) smooth(part, cleaned);
}

/// First along rows, then along columns.
void DepthCleaner::smooth(const Rect& part, Image<std::uint16_t>& cleaned) {
  half_smooth_ = cleaned;
  const auto by_rows = [&](const auto& visit) {
    for_rows(part.height, [&](Rows rows) {
      for (int y = part.y + rows.first; y < part.y + rows.last; ++y) visit(y);
    });
  };
  constexpr int reach = smoothing_reach;
  const int left = std::max(part.x, reach);
  const int right = std::min(part.right(), cleaned.width() - reach);
  by_rows([&](int y) {
    const std::uint16_t* from = cleaned.row(y);
    for (int x = left; x < right; ++x) half_smooth_(x, y) = smoothed(from + x, 1);
  });
  by_rows([&](int y) {
    if (y < reach || y >= cleaned.height() - reach) return;
    const std::uint16_t* from = half_smooth_.row(y);
    for (int x = left; x < right; ++x) cleaned(x, y) = smoothed(from + x, cleaned.width());
  });
}

/// The mean of pairs on both sides that lie on the same surface: on a slanted one, too, theirs is
/// the depth in the middle.
std::uint16_t DepthCleaner::smoothed(const std::uint16_t* pixel, std::ptrdiff_t step) const {
  if (*pixel == 0) return 0;
  const auto unit_m = static_cast<float>(camera_.depth_unit_m);
  const auto own = static_cast<float>(*pixel);
  const float limit = noise_m(own * unit_m) / unit_m;
  float sum = own;
  float count = 1;
  for (int k = 1; k <= smoothing_reach; ++k) {
    const std::uint16_t before = pixel[-k * step];
    const std::uint16_t after = pixel[k * step];
    const float pair = static_cast<float>(before) + static_cast<float>(after);
    if (before == 0 || after == 0 || std::abs(pair / 2 - own) > limit) break;
    sum += pair;
    count += 2;
  }
  return static_cast<std::uint16_t>(sum / count + 0.5F);
}

/// A pixel beside a depth edge stays if it continues the surface on its other side.
void DepthCleaner::remove_flying(const Image<std::uint16_t>& depth, const Rect& part, int y,
                                 Image<std::uint16_t>& cleaned) const {
  constexpr int reach = 2;
  if (y < reach || y >= depth.height() - reach) return;
  const auto unit_m = static_cast<float>(camera_.depth_unit_m);
  const std::ptrdiff_t pitch = depth.width();
  const std::uint16_t* row = depth.row(y);
  const int last = std::min(depth.width() - reach, part.right());
  for (int x = std::max(reach, part.x); x < last; ++x) {
    if (row[x] == 0) continue;
    const float z = static_cast<float>(row[x]) * unit_m;
    const float noise = noise_m(z);
    const auto is_beyond_edge = [&](std::ptrdiff_t offset) {
      const float other = static_cast<float>(row[x + offset]) * unit_m;
      return other > 0 && std::abs(other - z) > 2.5F * noise;
    };
    const auto continues = [&](std::ptrdiff_t offset) {
      const float first = static_cast<float>(row[x + offset]) * unit_m;
      const float second = static_cast<float>(row[x + 2 * offset]) * unit_m;
      if (first == 0) return false;
      if (std::abs(first - z) <= 1.5F * noise) return true;
      // Along a plane 1/z changes evenly.
      const float inverse = second > 0 ? 2 / first - 1 / second : 1 / first;
      return std::abs(1 - inverse * z) * z <= 2.5F * noise;
    };
    for (const std::ptrdiff_t offset : {std::ptrdiff_t{1}, std::ptrdiff_t{-1}, pitch, -pitch}) {
      if (is_beyond_edge(offset) && !continues(-offset)) {
        cleaned(x, y) = 0;
        break;
      }
    }
  }
}

/// Along a row of the depth image the places in the colour image increase, but where something near
/// reaches over what is behind it.
void DepthCleaner::remove_hidden(const Rect& part, int y, float threshold_m, Row& row,
                                 Image<std::uint16_t>& cleaned) const {
  const auto unit_m = static_cast<float>(camera_.depth_unit_m);
  const auto side_m = static_cast<float>(camera_.color_from_depth.translation.x());
  const auto ahead_m = static_cast<float>(camera_.color_from_depth.translation.z());
  std::uint16_t* values = cleaned.row(y);
  const float* side = ray_side_.row(y);
  const float* ahead = ray_ahead_.row(y);
  float* depth_m = row.depth_m.data();
  float* place = row.place.data();
  for (int x = part.x; x < part.right(); ++x) {
    const float z = static_cast<float>(values[x]) * unit_m;
    depth_m[x] = z;
    place[x] = (side[x] * z + side_m) / std::max(ahead[x] * z + ahead_m, 1e-3F);
  }
  const auto margin = margin_px / static_cast<float>(camera_.depth.fx);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Front front{-infinity, 0};
  for (int x = part.x; x < part.right(); ++x) {
    if (values[x] == 0) continue;
    if (front.place > place[x] - margin && front.depth_m < depth_m[x] - threshold_m) {
      values[x] = 0;
    } else if (place[x] > front.place) {
      front = {place[x], depth_m[x]};
    }
  }
  front = {infinity, 0};
  for (int x = part.right() - 1; x >= part.x; --x) {
    if (values[x] == 0) continue;
    if (front.place < place[x] + margin && front.depth_m < depth_m[x] - threshold_m) {
      values[x] = 0;
    } else if (place[x] < front.place) {
      front = {place[x], depth_m[x]};
    }
  }
}

}  // namespace diminish
