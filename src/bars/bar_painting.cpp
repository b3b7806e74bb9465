#include "bars/bar_painting.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/rows.h"
#include "geometry/point_projection.h"

namespace diminish {
namespace {

constexpr int reach_px = BarProfile::reach_px;
/// A bar ends where so many places in a row show what would be behind it.
constexpr int seen_px = 16;
/// Colours from one end only: a mirror shows something else further along. At its other end a bar
/// hides so much less of what is invented or seen behind it.
constexpr float far_fade = 0.4F;
/// The outer part of what is beside a bar, over which it fades.
constexpr float soft_share = 0.5F;
/// Beside two bars the darker counts, as shadows do, if neither weighs so much less.
constexpr float least_rival = 0.5F;
constexpr std::size_t most_beside = 16;  ///< bars that are looked at in a row
/// Something this much nearer hides it.
constexpr float nearer_m = 0.03F;
constexpr float nearer_side_m = 0.02F;
constexpr int rows_together = 32;
constexpr float parallel = 0.98F;  ///< cosine, of planes

struct Columns {
  int begin, end;
};

/// So far from a bar's edges the wall beside it goes on with it.
float beside_px(const Bar& bar) {
  constexpr float widths = 2;
  constexpr float most_px = 25;
  return std::min(widths * bar.width_px, most_px);
}

/// Labels of planes that are parallel to the bar's, bit by bit.
unsigned labels_behind(const BarPainting::Input& input, const Bar& bar) {
  unsigned labels = 0;
  for (std::size_t i = 0; i < input.planes.size(); ++i) {
    if (input.planes[i].normal.dot(bar.plane.normal) > parallel) {
      labels |= 1U << (surface_label::first_plane + i);
    }
  }
  return labels;
}

/// The label's bit; 0 where there is none.
unsigned label_at(const Surfaces& surfaces, int x, int y) {
  return surfaces.region.contains(x, y) ? 1U << std::min<unsigned>(surfaces.label(x, y), 31) : 0;
}

/// Whether an RGB-D camera sees something in front of the bar, which is z_m away there.
bool is_covered(const Reconstruction& drawn, int x, int y, float z_m) {
  return drawn.region.contains(x, y) && drawn.depth_m(x, y) > 0 &&
         drawn.depth_m(x, y) < z_m - nearer_m;
}

/// The color takes the pixel's place as far as the weight says.
void mix(const Eigen::Array4f& color, float weight, Bgr& pixel) {
  const Eigen::Array4f below(pixel.b, pixel.g, pixel.r, 0);
  pixel = to_color((below + weight * (color - below)).head<3>());
}

/// Of a row: all that may be within `half` of the bar's middle, and little more.
Columns columns_of(const Bar& bar, float half, int y, const Rect& box) {
  const Eigen::Vector2f across = bar.across();
  const float wide = half + 1;
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

BarPainting::End BarPainting::find_end(const Input& input, const Bar& bar) {
  int seen = 0;
  float along = 1;
  for (;; ++along) {
    const Eigen::Vector2f at = bar.at(along, 0);
    if (!is_hidden(input.occlusion, at)) return {along, true};
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
  const Surfaces& surfaces = input.surfaces;
  const Columns columns = columns_of(bar, half, y, box);
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
    if (is_covered(input.drawn, x, y, z_m)) continue;
    if (!surfaces.standing_depth_m.empty() && surfaces.label(x, y) == surface_label::standing &&
        surfaces.standing_depth_m(x, y) < z_m - nearer_side_m) {
      continue;
    }
    Eigen::Array4f color = stroke.near_colors.at(side);
    const float share = std::clamp(along / stroke.length, 0.0F, 1.0F);
    if (stroke.has_far) color += share * (stroke.far_colors.at(side) - color);
    const float fade = stroke.has_far ? 1 : 1 - far_fade * share;
    mix(color, fade * weight, result.picture(x, y));
    if (weight < 0.5F) continue;
    counts.inpainted += origin == provenance::inpainted ? 1 : 0;
    ++counts.estimated;
    origin = provenance::estimated;
  }
}

BarPainting::Paint BarPainting::beside(const Bar& bar, const Stroke& stroke,
                                       const Eigen::Vector2f& at) {
  const float along = bar.along(at);
  const float side = bar.side(at);
  const float reach = beside_px(bar);
  const float rest = reach + bar.width_px / 2 - std::abs(side);
  if (rest <= 0 || along < -reach_px || along > stroke.end) return {};
  const float share = std::clamp(along / stroke.length, 0.0F, 1.0F);
  const Eigen::Array4f near = stroke.near_colors.at(side);
  const Eigen::Array4f far =
      stroke.has_far ? stroke.far_colors.at(side) : Eigen::Array4f(Eigen::Array4f::Zero());
  const bool has_near = near[3] >= 1;
  const bool has_far = far[3] >= 1;
  Paint paint;
  if (has_near && has_far) {
    paint = {1, near + share * (far - near)};
  } else if (has_near) {
    paint = {1 - far_fade * share, near};
  } else if (has_far) {
    paint = {1 - far_fade * (1 - share), far};
  }
  paint.weight *= std::min(1.F, rest / (soft_share * reach));
  return paint;
}

void BarPainting::paint_beside(const Input& input, DiminishedFrame& result) const {
  const Rect& box = input.objects;
  for_row_groups(box.height, rows_together, [&](Rows rows) {
    for (int y = box.y + rows.first; y < box.y + rows.last; ++y) {
      paint_beside(input, y, result);
    }
  });
}

void BarPainting::paint_beside(const Input& input, int y, DiminishedFrame& result) const {
  // The surest of those that reach this row.
  struct Reach {
    std::size_t bar;
    Columns columns;
  };
  std::array<Reach, most_beside> reaches;
  std::size_t count = 0;
  Columns all{input.objects.right(), input.objects.x};
  for (std::size_t i = 0; i < input.bars.size() && count < reaches.size(); ++i) {
    if (!strokes_[i].is_painted) continue;
    const Bar& bar = input.bars[i];
    const Columns columns = columns_of(bar, bar.width_px / 2 + beside_px(bar), y, input.objects);
    if (columns.begin >= columns.end) continue;
    reaches[count++] = {i, columns};
    all = {std::min(all.begin, columns.begin), std::max(all.end, columns.end)};
  }
  for (int x = all.begin; x < all.end; ++x) {
    if (result.provenance(x, y) != provenance::inpainted) continue;
    const unsigned label = label_at(input.surfaces, x, y);
    const Eigen::Vector2f at(static_cast<float>(x), static_cast<float>(y));
    Paint best;
    for (std::size_t k = 0; k < count; ++k) {
      const auto& [i, columns] = reaches[k];
      if (x < columns.begin || x >= columns.end || (label & strokes_[i].labels) == 0) {
        continue;
      }
      const Paint paint = beside(input.bars[i], strokes_[i], at);
      if (paint.weight <= 0) continue;
      if (paint.weight > least_rival * best.weight) {
        const bool both = best.weight > least_rival * paint.weight;
        best.color = both ? best.color.min(paint.color).eval() : paint.color;
      }
      best.weight = std::max(best.weight, paint.weight);
    }
    if (best.weight <= 0) continue;
    mix(best.color, best.weight, result.picture(x, y));
  }
}

void BarPainting::lay_out(const Input& input, const Bar& bar, Stroke& stroke) {
  const auto [length, leaves_mask] = find_end(input, bar);
  stroke.labels = labels_behind(input, bar);
  const auto collect = [&](float begin, float sign, BarProfile& colors) {
    return colors.collect(
        input.camera, input.occlusion, bar, begin, sign, beside_px(bar),
        [&](int x, int y) {
          const Eigen::Vector3f ray = input.views.ray(x, y);
          const float inverse = bar.plane.inverse_depth(ray.x(), ray.y());
          return inverse > 0 && !is_covered(input.drawn, x, y, 1 / inverse);
        },
        [&](int x, int y) { return (label_at(input.surfaces, x, y) & stroke.labels) != 0; });
  };
  stroke.is_painted = length > 0 && collect(0, -1, stroke.near_colors);
  if (!stroke.is_painted) return;
  stroke.length = length;
  stroke.has_far = bar.goes_on && leaves_mask && collect(length, 1, stroke.far_colors);
  if (stroke.has_far) stroke.far_colors.leave_out_unlike(stroke.near_colors, bar);
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
  paint_beside(input, result);
  for (std::size_t i = 0; i < input.bars.size(); ++i) {
    if (strokes_[i].is_painted) paint(input, input.bars[i], strokes_[i], result);
  }
}

}  // namespace diminish
