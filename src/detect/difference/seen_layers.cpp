#include "detect/difference/seen_layers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/channels.h"
#include "core/rows.h"
#include "core/tasks.h"
#include "render/sdct.h"

namespace diminish {
namespace {

/// As many columns of a depth image are used, at most twice as many.
constexpr int used_columns = 200;

/// The mean of four pixels around a place of the picture.
Eigen::Array3f color_around(ImageView<Bgr> picture, float u, float v) {
  constexpr int reach = 2;
  const int x = static_cast<int>(u);
  const int y = static_cast<int>(v);
  const int left = std::max(0, x - reach + 1);
  const int right = std::min(picture.width() - 1, x + reach);
  const int top = std::max(0, y - reach + 1);
  const int bottom = std::min(picture.height() - 1, y + reach);
  return (to_channels(picture(left, top)) + to_channels(picture(right, top)) +
          to_channels(picture(left, bottom)) + to_channels(picture(right, bottom))) /
         4;
}

/// A cell of four vertices: the upper left one, the one to its right, and those below.
using Cell = std::array<const LayerVertex*, 4>;

bool is_drawn(const Cell& cell, const sdct::Threshold& threshold) {
  float least = cell[0]->own_depth_m;
  float greatest = least;
  for (const LayerVertex* vertex : cell) {
    if (!(vertex->surface.depth_m > 0)) return false;
    least = std::min(least, vertex->own_depth_m);
    greatest = std::max(greatest, vertex->own_depth_m);
  }
  if (!(greatest - least < threshold.at(least))) return false;
  const float across = (cell[1]->x - cell[0]->x) * (cell[2]->y - cell[0]->y) -
                       (cell[1]->y - cell[0]->y) * (cell[2]->x - cell[0]->x);
  return across > 0;
}

void draw_cell(const Cell& cell, SeenLayers& layers) {
  const auto [left, right] =
      std::minmax({cell[0]->x, cell[1]->x, cell[2]->x, cell[3]->x});
  const auto [top, bottom] =
      std::minmax({cell[0]->y, cell[1]->y, cell[2]->y, cell[3]->y});
  const Rect picture = layers.nearest.bounds();
  const int first_x = std::max(0, static_cast<int>(std::ceil(left)));
  const int last_x = std::min(picture.width - 1, static_cast<int>(std::floor(right)));
  const int first_y = std::max(0, static_cast<int>(std::ceil(top)));
  const int last_y = std::min(picture.height - 1, static_cast<int>(std::floor(bottom)));
  if (first_x > last_x || first_y > last_y) return;
  SeenSurface surface = cell[0]->surface;
  surface.depth_m = (cell[0]->surface.depth_m + cell[1]->surface.depth_m +
                     cell[2]->surface.depth_m + cell[3]->surface.depth_m) /
                    4;
  for (int y = first_y; y <= last_y; ++y) {
    for (int x = first_x; x <= last_x; ++x) {
      SeenSurface& nearest = layers.nearest(x, y);
      SeenSurface& farthest = layers.farthest(x, y);
      if (nearest.source == 0 || surface.depth_m < nearest.depth_m) nearest = surface;
      if (surface.depth_m > farthest.depth_m) farthest = surface;
    }
  }
}

}  // namespace

SeenLayersDrawer::SeenLayersDrawer(const Rig& rig)
    : shrinkage_(std::max(1, static_cast<int>(std::lround(rig.color.width / double{usual_width})))) {
  width_ = std::max(1, rig.color.width / shrinkage_);
  height_ = std::max(1, rig.color.height / shrinkage_);
  for (const RgbdCamera& camera : rig.rgbd) {
    Camera& added = cameras_.emplace_back(
        Camera{.rows = VertexRows(camera, rig.color),
               .step = std::max(1, camera.depth.width / used_columns),
               .all_blocks = {},
               .no_depth_mask = Mask(camera.depth.width, camera.depth.height),
               .no_color_mask = Mask(camera.color.width, camera.color.height),
               .row = {},
               .vertices = {}});
    added.all_blocks.resize(camera.depth.width / BlockSet::width + 2,
                            camera.depth.height / BlockSet::height + 1);
    for (int row = 0; row < added.all_blocks.rows(); ++row) {
      for (int column = 0; column < added.all_blocks.columns(); ++column) {
        added.all_blocks(column, row) = 1;
      }
    }
    for (VertexRow& row : added.row) row.resize(camera.depth.width);
  }
}

void SeenLayersDrawer::draw(const FrameSet& frame, const Poses& poses, ColorMapsBySource maps,
                            const sdct::Threshold& threshold, SeenLayers& layers) {
  layers.nearest.resize(width_, height_, {});
  layers.farthest.resize(width_, height_, {});
  for_tasks(cameras_.size(), [&](std::size_t k) {
    Camera& camera = cameras_[k];
    camera.vertices.resize(0, 0);
    if (!frame.rgbd[k].available() || !poses.color_from_depth[k]) return;
    find_vertices(frame.rgbd[k], *poses.color_from_depth[k], maps[k + 1],
                  static_cast<std::uint8_t>(k + 1), camera);
  });
  for (const Camera& camera : cameras_) {
    const Image<LayerVertex>& vertices = camera.vertices;
    for (int y = 0; y + 1 < vertices.height(); ++y) {
      for (int x = 0; x + 1 < vertices.width(); ++x) {
        const Cell cell = {&vertices(x, y), &vertices(x + 1, y), &vertices(x, y + 1),
                           &vertices(x + 1, y + 1)};
        if (is_drawn(cell, threshold)) draw_cell(cell, layers);
      }
    }
  }
}

void SeenLayersDrawer::find_vertices(const RgbdFrame& images,
                                     const RigidTransform& color_from_depth, const ColorMap& map,
                                     std::uint8_t source, Camera& camera) const {
  const ImageView<std::uint16_t> depth = images.depth;
  const int step = camera.step;
  camera.vertices.resize(depth.width() / step, depth.height() / step);
  const VertexRows::Frame frame{depth,
                                camera.no_depth_mask,
                                camera.no_color_mask,
                                FloatTransform(color_from_depth),
                                camera.all_blocks,
                                0,
                                (depth.width() + BlockSet::width - 1) / BlockSet::width};
  const ImageView<Bgr> picture = images.color;
  const float scale = 1.F / static_cast<float>(shrinkage_);
  for_rows(camera.vertices.height(), [&](Rows rows) {
    VertexRow& row = camera.row[rows.band];
    for (int y = rows.first; y < rows.last; ++y) {
      camera.rows.project(frame, y * step, row);
      for (int x = 0; x < camera.vertices.width(); ++x) {
        const auto i = static_cast<std::size_t>(x * step);
        LayerVertex& vertex = camera.vertices(x, y);
        vertex = {};
        if (!(row.inverse_z[i] > 0)) continue;
        const float z = 1 / row.inverse_z[i];
        const float full_x = static_cast<float>(row.x[i]) / sdct::subpixels;
        const float full_y = static_cast<float>(row.y[i]) / sdct::subpixels;
        vertex.x = (full_x + 0.5F) * scale - 0.5F;
        vertex.y = (full_y + 0.5F) * scale - 0.5F;
        vertex.own_depth_m = row.depth_m[i];
        vertex.u = row.u_over_z[i] * z;
        vertex.v = row.v_over_z[i] * z;
        const Eigen::Array3f color = color_around(picture, vertex.u, vertex.v);
        vertex.surface = {z, to_color(map(color, full_x, full_y)), source};
      }
    }
  });
}

}  // namespace diminish
