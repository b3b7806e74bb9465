#include "remote/glance_maker.h"

#include <algorithm>

#include "pose/neighbourhood_brightness.h"
#include "scene/sample_grid.h"

namespace diminish {

GlanceMaker::GlanceMaker(const RgbdCamera& camera, const GlanceWishes& wishes)
    : camera_(camera), wishes_(wishes), lens_(camera.color), mesh_(camera, camera.color) {
  if (!wishes.marker_dictionary.empty()) detector_.emplace(wishes.marker_dictionary);
}

void GlanceMaker::make(const RgbdFrame& images, Glance& glance) {
  glance.color_stamp_s = images.color_stamp_s;
  glance.depth_stamp_s = images.depth_stamp_s;
  glance.spacings_px = wishes_.spacings_px;
  glance.points.clear();
  glance.markers.clear();
  glance.depth_parts.clear();
  const ImageView<std::uint16_t> depth = images.depth;
  glance.depth.resize(depth.width(), depth.height(), 0);
  if (detector_) detector_->detect(images.color, lens_, glance.markers);
  for (const Marker& marker : glance.markers) copy_depth_around(marker, depth, glance);
  const SampleGrid grid(depth.width(), depth.height(), wishes_.samples);
  glance.point_step_px = grid.step;
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      const int column = grid.column(j);
      const int row = grid.row(i);
      if (!is_on_surface(depth, column, row)) continue;
      GlancePoint point;
      point.column = static_cast<std::uint16_t>(column);
      point.row = static_cast<std::uint16_t>(row);
      float u = 0;
      float v = 0;
      SampleColor found;
      if (mesh_.texture(depth, column, row, u, v) && find_sample_color(images.color, u, v, found)) {
        point.has_color = true;
        point.color = found.color;
        point.even = found.even;
        for (std::size_t k = 0; k < point.brightness.size(); ++k) {
          point.brightness[k] =
              neighbourhood_brightness(images.color, u, v, wishes_.spacings_px[k]);
        }
      }
      glance.points.push_back(point);
      glance.depth(column, row) = depth(column, row);
    }
  }
}

void GlanceMaker::copy_depth_around(const Marker& marker, ImageView<std::uint16_t> depth,
                                    Glance& glance) const {
  const Rect part = depth_part_of(marker, mesh_, depth);
  if (part.empty()) return;
  glance.depth_parts.push_back(part);
  for (int y = part.y; y < part.bottom(); ++y) {
    std::copy_n(depth.row(y) + part.x, part.width, glance.depth.row(y) + part.x);
  }
}

Rect depth_part_of(const Marker& marker, const DepthMesh& mesh, ImageView<std::uint16_t> depth) {
  constexpr int step = 4;
  constexpr int margin = step + 2;
  Eigen::Vector2d least = marker.corners[0];
  Eigen::Vector2d most = marker.corners[0];
  for (const Eigen::Vector2d& corner : marker.corners) {
    least = least.cwiseMin(corner);
    most = most.cwiseMax(corner);
  }
  Rect part;
  for (int y = step / 2; y < depth.height(); y += step) {
    for (int x = step / 2; x < depth.width(); x += step) {
      float u = 0;
      float v = 0;
      if (depth(x, y) == 0 || !mesh.texture(depth, x, y, u, v)) continue;
      if (u >= least.x() && u <= most.x() && v >= least.y() && v <= most.y()) extend(part, x, y);
    }
  }
  return intersect(grow(part, margin), depth.bounds());
}

}  // namespace diminish
