#include "memory/torn_edges.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/rows.h"
#include "core/runs.h"

namespace diminish {
namespace {

/// Pixels that are looked at together: few are where a gap ends.
constexpr int lanes = sizeof(std::uint64_t);

/// Whether any of some pixels is not open but the one above is. Of bytes that are 0 or 1.
bool any_ends(const std::uint8_t* above, const std::uint8_t* own) {
  std::uint64_t above_word;
  std::uint64_t own_word;
  std::memcpy(&above_word, above, sizeof(above_word));
  std::memcpy(&own_word, own, sizeof(own_word));
  return (above_word & ~own_word) != 0;
}

}  // namespace

TornEdges::TornEdges(const Intrinsics& color, const KeyframeGrid& grid)
    : color_(color), grid_(grid) {}

void TornEdges::close(const View& view, const Mask& objects, const TiledRegion& part,
                      Reconstruction& drawn) {
  if (!rays_) rays_ = RayTable::of(color_);
  part_ = part;
  open_.resize(part.width, part.height);
  for_rows(part.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint8_t* const source = drawn.source.row(y + part.y);
      std::uint8_t* const open = open_.row(y) - part.x;
      part.for_each_gap(y + part.y, [&](int first, int last) {
        std::fill(open + first, open + last, std::uint8_t{1});
      });
      part.for_each_run(y + part.y, [&](int first, int last) {
        for (int x = first; x < last; ++x) open[x] = source[x] == 0 ? 1 : 0;
      });
    }
  });
  for_rows(part.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) close_along_row(view, objects, y, drawn);
  });
  for_rows(part.height, [&](Rows rows) {
    for (int y = std::max(1, rows.first); y < rows.last; ++y) {
      close_along_columns(view, objects, y, drawn);
    }
  });
}

void TornEdges::close_along_row(const View& view, const Mask& objects, int y,
                                Reconstruction& drawn) const {
  const std::uint8_t* const open = open_.row(y);
  const int end = part_.width;
  for (int first = find_other(open, 0, end, 0); first < end;) {
    const int last = find_equal(open, first, end, 0);
    if (last == end) return;
    const int x = part_.x + first;
    const int count = last - first;
    const int row = part_.y + y;
    if (first > 0 && count < 2 * reach_px()) {
      close_gap(view, objects, {{x - 1, row}, {x, row}, {x + count, row}, count}, drawn);
    }
    first = find_other(open, last, end, 0);
  }
}

void TornEdges::close_along_columns(const View& view, const Mask& objects, int y,
                                    Reconstruction& drawn) const {
  const auto end_at = [&](int x) {
    int count = 1;
    while (count < 2 * reach_px() && count < y && open_(x, y - count - 1) != 0) ++count;
    if (count == 2 * reach_px() || count == y) return;
    const int column = part_.x + x;
    const int row = part_.y + y;
    close_gap(view, objects,
              {{column, row - count - 1}, {column, row - count}, {column, row}, count}, drawn);
  };
  const std::uint8_t* const above = open_.row(y - 1);
  const std::uint8_t* const own = open_.row(y);
  part_.for_each_run(part_.y + y, [&](int first, int last) {
    const int end = last - part_.x;
    for (int x = first - part_.x; x < end; x += lanes) {
      if (x + lanes <= end && !any_ends(above + x, own + x)) continue;
      for (int i = x; i < std::min(x + lanes, end); ++i) {
        if (above[i] != 0 && own[i] == 0) end_at(i);
      }
    }
  });
}

void TornEdges::close_gap(const View& view, const Mask& objects, const Gap& gap,
                          Reconstruction& drawn) const {
  const int dx = gap.first.x - gap.before.x;
  const int dy = gap.first.y - gap.before.y;
  const float before_m = drawn.depth_m(gap.before.x, gap.before.y);
  const float after_m = drawn.depth_m(gap.after.x, gap.after.y);
  for (int i = std::max(0, gap.count - reach_px()); i < std::min(gap.count, reach_px()); ++i) {
    const Pixel pixel{gap.first.x + i * dx, gap.first.y + i * dy};
    if (objects(pixel.x, pixel.y) == 0) continue;
    close_pixel(view, pixel, before_m, drawn);
    close_pixel(view, pixel, after_m, drawn);
  }
}

/// Shows a surface there, if nothing nearer is shown.
void TornEdges::close_pixel(const View& view, const Pixel& pixel, float z_m,
                            Reconstruction& drawn) const {
  const auto& [x, y] = pixel;
  if (drawn.source(x, y) != 0 && z_m >= drawn.depth_m(x, y)) return;
  const Eigen::Vector2f ray = (*rays_)(x, y);
  const auto color = look(view, {ray.x() * z_m, ray.y() * z_m, z_m});
  if (!color) return;
  drawn.color(x, y) = {color->b, color->g, color->r, 255};
  drawn.depth_m(x, y) = z_m;
  drawn.source(x, y) = 1;
}

std::optional<Bgr> TornEdges::look(const View& view, const Eigen::Vector3f& x_in_color) const {
  constexpr float same_surface = 0.03F;
  const Eigen::Vector3f point = transform(view.keyframe_from_color, x_in_color);
  const auto at = project_exactly(grid_.lens(), point);
  if (!at) return std::nullopt;
  const Pixel place = nearest_pixel(*at);
  const Pixel pixel = nearest_pixel(static_cast<float>(grid_.step()) * *at);
  if (!view.depth.bounds().contains(place.x, place.y) ||
      !view.picture.bounds().contains(pixel.x, pixel.y)) {
    return std::nullopt;
  }
  const float there_m = KeyframeGrid::depth_m(view.depth(place.x, place.y));
  if (!(std::abs(there_m - point.z()) < same_surface * point.z())) return std::nullopt;
  return view.picture(pixel.x, pixel.y);
}

}  // namespace diminish
