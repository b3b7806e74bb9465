#include "bars/bar_painting.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/channels.h"
#include "core/rows.h"
#include "geometry/point_projection.h"

namespace diminish {
namespace {

/// Colours are those of so many pixels along the bar, and known so far beyond its edges.
constexpr int colors_px = 20;
constexpr float margin_px = 2;
constexpr int reach_px = 60;  ///< the mask may begin so much earlier or later beside the middle
/// A bar ends where so many places in a row show what would be behind it.
constexpr int seen_px = 16;
/// Colours from one end only: a mirror shows something else further along. At its other end a bar
/// hides so much less of what is invented or seen behind it.
constexpr float far_fade = 0.4F;
/// Something this much nearer hides it.
constexpr float nearer_m = 0.03F;
constexpr float nearer_side_m = 0.02F;
constexpr int rows_together = 32;

struct Columns {
  int begin, end;
};

/// Of a row: all that may show the bar, and little more.
Columns columns_of(const Bar& bar, int y, const Rect& box) {
  const Eigen::Vector2f across = bar.across();
  const float wide = bar.width_px / 2 + 1;
  constexpr float level = 1e-3F;
  if (std::abs(across.x()) < level) return {box.x, box.right()};
  const float middle =
      bar.entry.x() - across.y() * (static_cast<float>(y) - bar.entry.y()) / across.x();
  const float reach = wide / std::abs(across.x()) + 1;
  const auto column = [&](float x) {
    return static_cast<int>(
        std::clamp(x, static_cast<float>(box.x), static_cast<float>(box.right())));
  };
  return {column(middle - reach), column(middle + reach + 1)};
}

}  // namespace

/// The mean colours across the bar, from `begin` on along it, in the direction of `sign`.
bool BarPainting::collect(const Input& input, const Bar& bar, float begin, float sign,
                          Profile& profile) {
  const int size = static_cast<int>(std::ceil(bar.width_px + 2 * margin_px)) + 1;
  profile.assign(static_cast<std::size_t>(size), Eigen::Array4f::Zero());
  for (int i = 0; i < size; ++i) {
    const float side = static_cast<float>(i) - bar.width_px / 2 - margin_px;
    int count = 0;
    Eigen::Array4f& color = profile[static_cast<std::size_t>(i)];
    for (int k = 1; k <= reach_px + colors_px && count < colors_px; ++k) {
      const auto [x, y] = nearest_pixel(bar.at(begin + sign * static_cast<float>(k), side));
      if (!input.camera.bounds().contains(x, y)) break;
      if (input.occlusion(x, y) != 0) continue;
      color.head<3>() += to_channels(input.camera(x, y));
      ++count;
    }
    if (count < colors_px / 4) return false;
    color /= static_cast<float>(count);
  }
  return true;
}

BarPainting::End BarPainting::find_end(const Input& input, const Bar& bar) {
  int seen = 0;
  float along = 1;
  for (;; ++along) {
    const Eigen::Vector2f at = bar.at(along, 0);
    const auto [x, y] = nearest_pixel(at);
    if (!input.occlusion.bounds().contains(x, y) || input.occlusion(x, y) == 0) {
      return {along, true};
    }
    const Eigen::Vector3f ray = input.views.ray(at);
    const float inverse = bar.plane.inverse_depth(ray.x(), ray.y());
    if (!(inverse > 0)) return {along, false};
    const Eigen::Vector3f point = ray / inverse;
    const bool is_within =
        std::any_of(input.planes.begin(), input.planes.end(),
                    [&](const BackgroundPlane& plane) { return plane.height_m(point) <= 0; });
    if (is_within) return {along, false};
    seen = input.views.look_at(point) == BarViews::Place::seen ? seen + 1 : 0;
    if (seen == seen_px) return {along - seen_px, false};
  }
}

void BarPainting::paint_row(const Input& input, const Bar& bar, const Stroke& stroke, int y,
                            const Rect& box, DiminishedFrame& result, Counts& counts) {
  const float half = bar.width_px / 2;
  const Reconstruction& drawn = result.reconstruction;
  const Surfaces& surfaces = result.surfaces;
  const auto color_at = [](const Profile& profile, float position) -> Eigen::Array4f {
    const auto first = std::min(static_cast<std::size_t>(position), profile.size() - 2);
    const float share = position - static_cast<float>(first);
    return profile[first] + share * (profile[first + 1] - profile[first]);
  };
  const Columns columns = columns_of(bar, y, box);
  for (int x = columns.begin; x < columns.end; ++x) {
    std::uint8_t& origin = result.provenance(x, y);
    if (input.occlusion(x, y) == 0 || origin == provenance::witnessed ||
        origin == provenance::remembered || origin == provenance::estimated) {
      continue;
    }
    const Eigen::Vector2f at(static_cast<float>(x), static_cast<float>(y));
    const float along = bar.along(at);
    const float side = bar.side(at);
    const float weight = std::min(half + 0.5F - std::abs(side), 1.0F);
    if (weight <= 0 || along < -reach_px || along > stroke.end) continue;
    const Eigen::Vector3f ray = input.views.ray(x, y);
    const float inverse = bar.plane.inverse_depth(ray.x(), ray.y());
    if (!(inverse > 0)) continue;
    const float z_m = 1 / inverse;
    const bool has_drawn = drawn.region.contains(x, y) && drawn.depth_m(x, y) > 0;
    if (has_drawn && drawn.depth_m(x, y) < z_m - nearer_m) continue;
    if (!surfaces.standing_depth_m.empty() && surfaces.label(x, y) == surface_label::standing &&
        surfaces.standing_depth_m(x, y) < z_m - nearer_side_m) {
      continue;
    }
    const float position = side + half + margin_px;
    Eigen::Array4f color = color_at(stroke.near_colors, position);
    const float share = std::clamp(along / stroke.length, 0.0F, 1.0F);
    if (stroke.has_far) color += share * (color_at(stroke.far_colors, position) - color);
    Bgr& pixel = result.picture(x, y);
    const Eigen::Array4f below(pixel.b, pixel.g, pixel.r, 0);
    const float fade = stroke.has_far ? 1 : 1 - far_fade * share;
    pixel = to_color((below + fade * weight * (color - below)).head<3>());
    if (weight < 0.5F) continue;
    counts.inpainted += origin == provenance::inpainted ? 1 : 0;
    ++counts.estimated;
    origin = provenance::estimated;
  }
}

void BarPainting::lay_out(const Input& input, const Bar& bar, Stroke& stroke) {
  const auto [length, leaves_mask] = find_end(input, bar);
  stroke.is_painted = length > 0 && collect(input, bar, 0, -1, stroke.near_colors);
  if (!stroke.is_painted) return;
  stroke.length = length;
  stroke.has_far = bar.goes_on && leaves_mask && collect(input, bar, length, 1, stroke.far_colors);
  stroke.end = leaves_mask ? length + reach_px : length;
}

void BarPainting::lay_out(const Input& input) {
  if (strokes_.size() < input.bars.size()) strokes_.resize(input.bars.size());
  for_tasks(input.bars.size(), [&](std::size_t i) { lay_out(input, input.bars[i], strokes_[i]); });
}

void BarPainting::paint(const Input& input, const Bar& bar, const Stroke& stroke,
                        DiminishedFrame& result) {
  const float half = bar.width_px / 2;
  Eigen::Array2f low = bar.at(-reach_px, -half), high = low;
  for (const Eigen::Vector2f& corner :
       {bar.at(-reach_px, half), bar.at(stroke.end, -half), bar.at(stroke.end, half)}) {
    low = low.min(corner.array());
    high = high.max(corner.array());
  }
  const auto floor = [](float value) { return static_cast<int>(std::floor(value)) - 1; };
  const Rect box = intersect({floor(low.x()), floor(low.y()), floor(high.x()) - floor(low.x()) + 3,
                              floor(high.y()) - floor(low.y()) + 3},
                             input.objects);
  std::atomic<std::size_t> estimated = 0;
  std::atomic<std::size_t> inpainted = 0;
  for_row_groups(box.height, rows_together, [&](Rows rows) {
    Counts counts;
    for (int y = box.y + rows.first; y < box.y + rows.last; ++y) {
      paint_row(input, bar, stroke, y, box, result, counts);
    }
    estimated += counts.estimated;
    inpainted += counts.inpainted;
  });
  result.report.missing_pixels -= inpainted;
  result.report.valid_pixels += inpainted;
  result.report.estimated_pixels += estimated;
}

void BarPainting::paint(const Input& input, DiminishedFrame& result) const {
  for (std::size_t i = 0; i < input.bars.size(); ++i) {
    if (strokes_[i].is_painted) paint(input, input.bars[i], strokes_[i], result);
  }
}

}  // namespace diminish
