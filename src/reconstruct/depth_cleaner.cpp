#include "reconstruct/depth_cleaner.h"

#include <algorithm>

#include "core/rows.h"
#include "geometry/projection.h"
#include "reconstruct/depth_rows.h"

namespace diminish {
namespace {

using depth_rows::reach;

/// How far, in depth pixels, from what hides it a pixel must be in the colour image: both are
/// blurred.
constexpr float margin_px = 1;

/// The part that is `reach` away from the images' borders.
Rect inside(const Rect& part, const Image<std::uint16_t>& depth) {
  return intersect(part, {reach, reach, depth.width() - 2 * reach, depth.height() - 2 * reach});
}

}  // namespace

DepthCleaner::DepthCleaner(const RgbdCamera& camera) : camera_(camera), edge_snapping_(camera) {
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

void DepthCleaner::clean(const Image<std::uint16_t>& depth, const EdgeSnapping::Images& images,
                         const Rect& part, const Options& options, Image<std::uint16_t>& cleaned) {
  cleaned = depth;
  if (options.remove_flying) remove_flying(depth, part, cleaned);
  if (options.smooth_depth) smooth(part, cleaned);
  if (options.snap_edges) edge_snapping_.snap(images, part, cleaned);
  if (options.remove_hidden) {
    remove_hidden(part, static_cast<float>(options.discontinuity_threshold_m), cleaned);
  }
}

void DepthCleaner::remove_flying(const Image<std::uint16_t>& depth, const Rect& part,
                                 Image<std::uint16_t>& cleaned) const {
  const Rect inner = inside(part, depth);
  for_rows(inner.height, [&](Rows rows) {
    for (int y = inner.y + rows.first; y < inner.y + rows.last; ++y) {
      depth_rows::remove_flying(row(depth.row(y) + inner.x, inner.width), depth.width(),
                                cleaned.row(y) + inner.x);
    }
  });
}

void DepthCleaner::remove_hidden(const Rect& part, float threshold_m,
                                 Image<std::uint16_t>& cleaned) {
  const auto side_m = static_cast<float>(camera_.color_from_depth.translation.x());
  const auto ahead_m = static_cast<float>(camera_.color_from_depth.translation.z());
  const auto unit_m = static_cast<float>(camera_.depth_unit_m);
  const auto margin = margin_px / static_cast<float>(camera_.depth.fx);
  for_rows(part.height, [&](Rows rows) {
    Scratch& scratch = scratch_[rows.first == 0 ? 0 : 1];
    scratch.depth_m.resize(static_cast<std::size_t>(part.width + 16));
    scratch.place.resize(static_cast<std::size_t>(part.width + 16));
    for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
      const depth_rows::Places places{ray_side_.row(y) + part.x, ray_ahead_.row(y) + part.x, side_m,
                                      ahead_m};
      depth_rows::remove_hidden(places, unit_m, margin, threshold_m, part.width,
                                cleaned.row(y) + part.x, scratch.depth_m.data(),
                                scratch.place.data());
    }
  });
}

/// First along rows, then along columns.
void DepthCleaner::smooth(const Rect& part, Image<std::uint16_t>& cleaned) {
  half_smooth_ = cleaned;
  const auto by_rows = [&](int first, int last, const auto& visit) {
    for_rows(last - first, [&](Rows rows) {
      for (int y = first + rows.first; y < first + rows.last; ++y) visit(y);
    });
  };
  const Rect inner = inside(part, cleaned);
  by_rows(part.y, part.bottom(), [&](int y) {
    depth_rows::smooth(row(cleaned.row(y) + inner.x, inner.width), 1,
                       half_smooth_.row(y) + inner.x);
  });
  by_rows(inner.y, inner.bottom(), [&](int y) {
    depth_rows::smooth(row(half_smooth_.row(y) + inner.x, inner.width), cleaned.width(),
                       cleaned.row(y) + inner.x);
  });
}

depth_rows::Row DepthCleaner::row(const std::uint16_t* depth, int count) const {
  return {depth, count, static_cast<float>(camera_.depth_unit_m), {}};
}

}  // namespace diminish
