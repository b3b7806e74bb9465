#include "memory/torn_edges.h"

#include <cmath>

#include "core/rows.h"

namespace diminish {

TornEdges::TornEdges(const Intrinsics& color, const KeyframeGrid& grid)
    : color_(color), grid_(grid) {}

void TornEdges::close(const View& view, const Mask& objects, const Rect& part,
                      Reconstruction& drawn) {
  if (!rays_) rays_ = RayTable::of(color_);
  part_ = part;
  gaps_.resize(part.width, part.height);
  for_rows(part.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint8_t* const masked = objects.row(y + part.y) + part.x;
      const std::uint8_t* const source = drawn.source.row(y + part.y) + part.x;
      std::uint8_t* const gaps = gaps_.row(y);
      for (int x = 0; x < part.width; ++x) gaps[x] = masked[x] != 0 && source[x] == 0 ? 1 : 0;
    }
  });
  for_rows(part.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < part.width; ++x) {
        if (gaps_(x, y) != 0) close_at(view, x, y, drawn);
      }
    }
  });
}

float TornEdges::depth_beside(const Reconstruction& drawn, int x, int y, int dx, int dy) const {
  constexpr int cells = 2;
  for (int i = 1; i <= cells * grid_.step(); ++i) {
    const int column = x + i * dx;
    const int row = y + i * dy;
    if (!gaps_.bounds().contains(column, row)) return 0;
    if (gaps_(column, row) != 0) continue;
    const bool is_drawn = drawn.source(column + part_.x, row + part_.y) != 0;
    if (is_drawn) return drawn.depth_m(column + part_.x, row + part_.y);
  }
  return 0;
}

std::optional<Bgr> TornEdges::look(const View& view, const Eigen::Vector3f& x_in_color) const {
  constexpr float same_surface = 0.03F;
  const Eigen::Vector3f point = transform(view.keyframe_from_color, x_in_color);
  float u = 0;
  float v = 0;
  if (!(point.z() > PointView::nearest_m) ||
      !grid_.lens().distort(point.x() / point.z(), point.y() / point.z(), u, v)) {
    return std::nullopt;
  }
  const auto scale = static_cast<float>(grid_.step());
  const auto rounded = [](float value) { return static_cast<int>(std::lrint(value)); };
  const Pixel place{rounded(u), rounded(v)};
  const Pixel pixel{rounded(u * scale), rounded(v * scale)};
  if (!view.depth.bounds().contains(place.x, place.y) ||
      !view.picture.bounds().contains(pixel.x, pixel.y)) {
    return std::nullopt;
  }
  const float there_m = KeyframeGrid::depth_m(view.depth(place.x, place.y));
  if (!(std::abs(there_m - point.z()) < same_surface * point.z())) return std::nullopt;
  return view.picture(pixel.x, pixel.y);
}

void TornEdges::close_at(const View& view, int x, int y, Reconstruction& drawn) const {
  const int column = x + part_.x;
  const int row = y + part_.y;
  const Eigen::Vector2f ray = (*rays_)(column, row);
  float shown_m = 0;
  Bgr shown;
  for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}}) {
    const float before_m = depth_beside(drawn, x, y, -dx, -dy);
    const float after_m = depth_beside(drawn, x, y, dx, dy);
    if (before_m == 0 || after_m == 0) continue;
    for (const float z_m : {before_m, after_m}) {
      if (shown_m > 0 && z_m >= shown_m) continue;
      const auto color = look(view, {ray.x() * z_m, ray.y() * z_m, z_m});
      if (!color) continue;
      shown_m = z_m;
      shown = *color;
    }
  }
  if (shown_m == 0) return;
  drawn.color(column, row) = {shown.b, shown.g, shown.r, 255};
  drawn.depth_m(column, row) = shown_m;
  drawn.source(column, row) = 1;
}

}  // namespace diminish
