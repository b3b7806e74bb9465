#include "detect/difference/rgbd_object.h"

#include <algorithm>
#include <cmath>

namespace diminish {
namespace {

/// How far a surface may be from the nearest one of its line of sight and still be that.
constexpr float same_surface = 0.03F;
/// Pixels of the small picture that the object's outline may be off by.
constexpr int outline_error = 1;

Rect square_around(int x, int y, int reach) {
  return {x - reach, y - reach, 2 * reach + 1, 2 * reach + 1};
}

bool any_set(const Mask& mask, const Rect& part) {
  for (int y = part.y; y < part.bottom(); ++y) {
    if (std::any_of(mask.row(y) + part.x, mask.row(y) + part.right(),
                    [](std::uint8_t value) { return value != 0; })) {
      return true;
    }
  }
  return false;
}

}  // namespace

bool RgbdObject::add(const Inputs& inputs, const Image<LayerVertex>& vertices, int step,
                     Mask& depth_mask, Mask& color_mask) {
  const Mask& regions = inputs.regions;
  const Rect picture = regions.bounds();
  const Rect near = intersect(grow(bounding_box(regions), outline_error), picture);
  const auto pixel = [](const LayerVertex& vertex) {
    return Eigen::Vector2i(static_cast<int>(std::lrint(vertex.x)),
                           static_cast<int>(std::lrint(vertex.y)));
  };
  const auto may_be_object = [&](const LayerVertex& vertex, int error) {
    if (!(vertex.depth_m > 0)) return false;
    const Eigen::Vector2i at = pixel(vertex);
    if (!near.contains(at.x(), at.y())) return false;
    return any_set(regions, intersect(square_around(at.x(), at.y(), error), picture)) &&
           !inputs.evidence.is_on_plane(inputs.planes, at.x(), at.y(), vertex.depth_m);
  };
  visited_.resize(vertices.width(), vertices.height(), 0);
  open_ends_.clear();
  for (int y = 0; y < vertices.height(); ++y) {
    for (int x = 0; x < vertices.width(); ++x) {
      const LayerVertex& vertex = vertices(x, y);
      if (!(vertex.depth_m > 0)) continue;
      const Eigen::Vector2i at = pixel(vertex);
      if (!near.contains(at.x(), at.y())) continue;
      if (inputs.shown(at.x(), at.y()) != Shown::object) continue;
      const float nearest_m = inputs.layers.nearest(at.x(), at.y()).depth_m;
      if (vertex.depth_m > (1 + same_surface) * nearest_m || !may_be_object(vertex, 0)) continue;
      visited_(x, y) = 255;
      open_ends_.emplace_back(x, y);
    }
  }
  const bool any = !open_ends_.empty();
  const int reach = vertices.empty()
                        ? 0
                        : (step * color_mask.width() + depth_mask.width() - 1) / depth_mask.width();
  while (!open_ends_.empty()) {
    const Eigen::Vector2i at = open_ends_.back();
    open_ends_.pop_back();
    const LayerVertex& own = vertices(at.x(), at.y());
    depth_mask.fill(intersect({at.x() * step, at.y() * step, step, step}, depth_mask.bounds()),
                    255);
    color_mask.fill(
        intersect(square_around(static_cast<int>(own.u), static_cast<int>(own.v), (reach + 1) / 2),
                  color_mask.bounds()),
        255);
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const int x = at.x() + dx;
      const int y = at.y() + dy;
      if (!visited_.bounds().contains(x, y) || visited_(x, y) != 0) continue;
      const LayerVertex& other = vertices(x, y);
      if (!may_be_object(other, outline_error)) continue;
      const float nearer = std::min(own.own_depth_m, other.own_depth_m);
      if (!(std::abs(own.own_depth_m - other.own_depth_m) < inputs.threshold.at(nearer))) continue;
      visited_(x, y) = 255;
      open_ends_.emplace_back(x, y);
    }
  }
  return any;
}

}  // namespace diminish
