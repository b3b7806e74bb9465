#include "depth/depth_cleaner.h"

#include <algorithm>

#include "core/rows.h"
#include "depth/depth_rows.h"

namespace diminish {
namespace {

using depth_rows::reach;

/// How far, in depth pixels, a pixel must be from what hides it in the colour image: both are
/// blurred.
constexpr float margin_px = 1;

/// The part at least `reach` away from the image's borders.
Rect inside(ImageView<std::uint16_t> depth) {
  return {reach, reach, depth.width() - 2 * reach, depth.height() - 2 * reach};
}

}  // namespace

DepthCleaner::DepthCleaner(const RgbdCamera& camera)
    : camera_(camera),
      rays_(RayTable::of(camera.depth)),
      smoothing_(static_cast<float>(camera.depth_unit_m)),
      edge_snapping_(camera) {}

void DepthCleaner::clean(ImageView<std::uint16_t> depth, const EdgeSnapping::Images& images,
                         const DepthPart& part, const Options& options,
                         Image<std::uint16_t>& cleaned) {
  copy(depth, cleaned);
  if (options.smooth_depth) {
    smooth(depth, part, options.remove_flying, cleaned);
  } else if (options.remove_flying) {
    remove_flying(depth, part, cleaned);
  }
  if (options.snap_edges) edge_snapping_.snap(images, part, cleaned);
  if (options.remove_hidden) {
    remove_hidden(part, static_cast<float>(options.discontinuity_threshold_m), cleaned);
  }
}

void DepthCleaner::remove_flying(ImageView<std::uint16_t> depth, const DepthPart& part,
                                 Image<std::uint16_t>& cleaned) const {
  const auto pitch = static_cast<int>(depth.stride() / std::ptrdiff_t{sizeof(std::uint16_t)});
  for_each_row(part, inside(depth), [&](int y, const DepthPart::Columns& columns) {
    depth_rows::remove_flying(row(depth, y, columns), pitch, cleaned.row(y) + columns.first);
  });
}

void DepthCleaner::remove_hidden(const DepthPart& part, float threshold_m,
                                 Image<std::uint16_t>& cleaned) {
  const FloatTransform to_color(camera_.color_from_depth);
  const auto unit_m = static_cast<float>(camera_.depth_unit_m);
  const auto margin = margin_px / static_cast<float>(camera_.depth.fx);
  const Rect& bounds = part.bounds();
  for_rows(bounds.height, [&](Rows rows) {
    Scratch& scratch = scratch_[rows.band];
    const std::size_t room = static_cast<std::size_t>(bounds.width) + 16;
    scratch.depth_m.resize(room);
    scratch.place.resize(room);
    for (int y = bounds.y + rows.first; y < bounds.y + rows.last; ++y) {
      const DepthPart::Columns& columns = part.columns(y);
      const depth_rows::Places places{rays_->x(y) + columns.first, rays_->y(y) + columns.first,
                                      to_color};
      depth_rows::remove_hidden(places, unit_m, margin, threshold_m, columns.count(),
                                cleaned.row(y) + columns.first, scratch.depth_m.data(),
                                scratch.place.data());
    }
  });
}

/// Flying pixels around the part are left out, too: what a pixel becomes must not depend on where
/// the part ends, which another machine may choose otherwise.
void DepthCleaner::smooth(ImageView<std::uint16_t> depth, const DepthPart& part,
                          bool without_flying, Image<std::uint16_t>& cleaned) {
  given_.resize(depth.width(), depth.height());
  around_.grow_from(part, DepthSmoothing::reach, depth.bounds());
  for_each_row(around_, depth.bounds(), [&](int y, const DepthPart::Columns& columns) {
    std::copy_n(depth.row(y) + columns.first, columns.count(), given_.row(y) + columns.first);
  });
  if (without_flying) remove_flying(depth, around_, given_);
  smoothing_.smooth(depth, given_, part, cleaned);
}

depth_rows::Row DepthCleaner::row(ImageView<std::uint16_t> depth, int y,
                                  const DepthPart::Columns& columns) const {
  return {
      depth.row(y) + columns.first, columns.count(), static_cast<float>(camera_.depth_unit_m), {}};
}

}  // namespace diminish
