#include "render/rasterizer.h"

#include <algorithm>
#include <cmath>

#include "render/sdct.h"

namespace diminish {
namespace {

/// The edge function of the edge from `a` to `b`: positive for points on the triangle's side.
struct Edge {
  std::int64_t step_x, step_y, value_at_origin;

  Edge(const MeshVertex& a, const MeshVertex& b)
      : step_x(-(static_cast<std::int64_t>(b.y) - a.y)),
        step_y(static_cast<std::int64_t>(b.x) - a.x),
        value_at_origin(-step_x * a.x - step_y * a.y) {}

  std::int64_t at(int column, int row) const {
    return value_at_origin + (step_x * column + step_y * row) * sdct::subpixels;
  }
  /// Top edges run to the right along a row, left edges upwards.
  bool top_or_left() const { return step_x > 0 || (step_x == 0 && step_y > 0); }
  bool covers(std::int64_t value) const { return value > 0 || (value == 0 && top_or_left()); }
};

int floor_to_pixel(std::int32_t subpixels) {
  return subpixels >> sdct::subpixel_bits;
}
int ceil_to_pixel(std::int32_t subpixels) {
  return (subpixels + sdct::subpixels - 1) >> sdct::subpixel_bits;
}

Rect pixels_of_bounding_box(const MeshVertex& a, const MeshVertex& b, const MeshVertex& c) {
  const int left = ceil_to_pixel(std::min({a.x, b.x, c.x}));
  const int top = ceil_to_pixel(std::min({a.y, b.y, c.y}));
  return {left, top, floor_to_pixel(std::max({a.x, b.x, c.x})) - left + 1,
          floor_to_pixel(std::max({a.y, b.y, c.y})) - top + 1};
}

}  // namespace

void Layer::clear(int width, int height, const Rect& region) {
  color.resize(width, height);
  depth_m.resize(width, height);
  texture.resize(width, height);
  color.fill(region, {});
  depth_m.fill(region, 0.F);
}

Bgr sample_bilinear(ImageView<Bgr> image, float u, float v) {
  const int x0 = std::clamp(static_cast<int>(u), 0, image.width() - 1);
  const int y0 = std::clamp(static_cast<int>(v), 0, image.height() - 1);
  const int x1 = std::min(x0 + 1, image.width() - 1);
  const int y1 = std::min(y0 + 1, image.height() - 1);
  const float fx = u - static_cast<float>(x0);
  const float fy = v - static_cast<float>(y0);
  const auto blend = [&](auto channel) {
    const auto at = [&](int x, int y) { return static_cast<float>(image(x, y).*channel); };
    const float top = at(x0, y0) + fx * (at(x1, y0) - at(x0, y0));
    const float bottom = at(x0, y1) + fx * (at(x1, y1) - at(x0, y1));
    return static_cast<std::uint8_t>(std::lrint(top + fy * (bottom - top)));
  };
  return {blend(&Bgr::b), blend(&Bgr::g), blend(&Bgr::r)};
}

void draw_triangle(const MeshVertex& a, const MeshVertex& b, const MeshVertex& c,
                   ImageView<Bgr> texture, const Rect& region, Layer& layer) {
  const Rect box = intersect(pixels_of_bounding_box(a, b, c), region);
  if (box.empty()) return;
  const Edge opposite_a(b, c);
  const Edge opposite_b(c, a);
  const Edge opposite_c(a, b);
  const float scale = 1.F / static_cast<float>(sdct::doubled_area(a.x, a.y, b.x, b.y, c.x, c.y));

  for (int row = box.y; row < box.bottom(); ++row) {
    for (int column = box.x; column < box.right(); ++column) {
      const std::int64_t edge_a = opposite_a.at(column, row);
      const std::int64_t edge_b = opposite_b.at(column, row);
      const std::int64_t edge_c = opposite_c.at(column, row);
      if (!opposite_a.covers(edge_a) || !opposite_b.covers(edge_b) || !opposite_c.covers(edge_c)) {
        continue;
      }
      // 1/z, u/z and v/z are linear in the picture.
      const float weight_a = static_cast<float>(edge_a) * scale * a.inverse_z;
      const float weight_b = static_cast<float>(edge_b) * scale * b.inverse_z;
      const float weight_c = static_cast<float>(edge_c) * scale * c.inverse_z;
      const float z = 1.F / (weight_a + weight_b + weight_c);
      float& nearest = layer.depth_m(column, row);
      if (nearest > 0 && !(z < nearest)) continue;
      nearest = z;
      const float u = (weight_a * a.u + weight_b * b.u + weight_c * c.u) * z;
      const float v = (weight_a * a.v + weight_b * b.v + weight_c * c.v) * z;
      const Bgr color = sample_bilinear(texture, u, v);
      layer.texture(column, row) = {u, v};
      layer.color(column, row) = {color.b, color.g, color.r, 255};
    }
  }
}

void draw_mesh(const Image<MeshVertex>& vertices, ImageView<Bgr> texture,
               const sdct::Threshold& threshold, const Rect& region, Layer& layer) {
  const auto draw = [&](const MeshVertex& a, const MeshVertex& b, const MeshVertex& c) {
    if (a.valid() && b.valid() && c.valid() &&
        sdct::joined(a.depth_m, b.depth_m, c.depth_m, threshold) &&
        sdct::faces_forward(sdct::doubled_area(a.x, a.y, b.x, b.y, c.x, c.y))) {
      draw_triangle(a, b, c, texture, region, layer);
    }
  };
  for (int row = 0; row + 1 < vertices.height(); ++row) {
    const MeshVertex* upper = vertices.row(row);
    const MeshVertex* lower = vertices.row(row + 1);
    for (int column = 0; column + 1 < vertices.width(); ++column) {
      draw(upper[column], upper[column + 1], lower[column]);
      draw(upper[column + 1], lower[column + 1], lower[column]);
    }
  }
}

}  // namespace diminish
