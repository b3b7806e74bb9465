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
  const Bgr* const upper = picture.row(std::max(0, y - reach + 1));
  const Bgr* const lower = picture.row(std::min(picture.height() - 1, y + reach));
  const Bgr a = upper[left];
  const Bgr b = upper[right];
  const Bgr c = lower[left];
  const Bgr d = lower[right];
  return Eigen::Array3f(static_cast<float>(a.b + b.b + c.b + d.b),
                        static_cast<float>(a.g + b.g + c.g + d.g),
                        static_cast<float>(a.r + b.r + c.r + d.r)) /
         4;
}

/// A cell of four vertices: the upper left one, the one to its right, and those below.
using Cell = std::array<const LayerVertex*, 4>;

bool is_drawn(const Cell& cell, const sdct::Threshold& threshold) {
  float least = cell[0]->own_depth_m;
  float greatest = least;
  for (const LayerVertex* vertex : cell) {
    if (!(vertex->depth_m > 0)) return false;
    least = std::min(least, vertex->own_depth_m);
    greatest = std::max(greatest, vertex->own_depth_m);
  }
  if (!(greatest - least < threshold.at(least))) return false;
  const float across = (cell[1]->x - cell[0]->x) * (cell[2]->y - cell[0]->y) -
                       (cell[1]->y - cell[0]->y) * (cell[2]->x - cell[0]->x);
  return across > 0;
}

/// The least whole number that is not less, and the greatest that is not more; 0 for less than 0.
int round_up(float value) {
  const int down = static_cast<int>(std::max(0.F, value));
  return down + (static_cast<float>(down) < value ? 1 : 0);
}
int round_down(float value) {
  return static_cast<int>(std::max(0.F, value));
}

/// The pixels inside a cell's bounding box, and how far away they are.
DrawnCell bounds_of(const Cell& cell, const Rect& picture) {
  const auto [left, right] = std::minmax({cell[0]->x, cell[1]->x, cell[2]->x, cell[3]->x});
  const auto [top, bottom] = std::minmax({cell[0]->y, cell[1]->y, cell[2]->y, cell[3]->y});
  if (!(right >= 0 && bottom >= 0)) return {};
  DrawnCell drawn;
  drawn.left = round_up(left);
  drawn.right = std::min(picture.width, round_down(right) + 1);
  drawn.top = round_up(top);
  drawn.bottom = std::min(picture.height, round_down(bottom) + 1);
  drawn.surface.depth_m =
      (cell[0]->depth_m + cell[1]->depth_m + cell[2]->depth_m + cell[3]->depth_m) / 4;
  return drawn;
}

/// Rows [first, last).
void draw(const DrawnCell& cell, Rows rows, SeenLayers& layers) {
  const float depth_m = cell.surface.depth_m;
  for (int y = std::max(rows.first, cell.top); y < std::min(rows.last, cell.bottom); ++y) {
    for (int x = cell.left; x < cell.right; ++x) {
      SeenSurface& nearest = layers.nearest(x, y);
      SeenSurface& farthest = layers.farthest(x, y);
      if (nearest.source == 0 || depth_m < nearest.depth_m) nearest = cell.surface;
      if (depth_m > farthest.depth_m) farthest = cell.surface;
    }
  }
}

/// The camera, with every step-th column of every step-th row of its depth sensor.
RgbdCamera with_coarse_depth(RgbdCamera camera, int step) {
  Intrinsics& depth = camera.depth;
  depth.width /= step;
  depth.height /= step;
  depth.fx /= step;
  depth.fy /= step;
  depth.cx /= step;
  depth.cy /= step;
  return camera;
}

}  // namespace

SeenLayersDrawer::SeenLayersDrawer(const Rig& rig)
    : shrinkage_(
          std::max(1, static_cast<int>(std::lround(rig.color.width / double{usual_width})))) {
  color_bounds_ = rig.color.bounds();
  width_ = std::max(1, rig.color.width / shrinkage_);
  height_ = std::max(1, rig.color.height / shrinkage_);
  for (const RgbdCamera& camera : rig.rgbd) {
    const int step = std::max(1, camera.depth.width / used_columns);
    const RgbdCamera coarse = with_coarse_depth(camera, step);
    cameras_.push_back({.step = step,
                        .rows = VertexRows(coarse, rig.color),
                        .visible = VisibleBlocks(coarse, rig.color),
                        .no_depth_mask = Mask(coarse.depth.width, coarse.depth.height),
                        .no_color_mask = Mask(camera.color.width, camera.color.height)});
  }
}

void SeenLayersDrawer::draw(const FrameSet& frame, const Poses& poses, ColorMapsBySource maps,
                            const sdct::Threshold& threshold, SeenLayers& layers) {
  for_tasks(cameras_.size(), [&](std::size_t k) {
    Camera& camera = cameras_[k];
    camera.vertices.resize(0, 0);
    if (!frame.rgbd[k].available() || !poses.color_from_depth[k]) return;
    find_vertices(frame.rgbd[k], *poses.color_from_depth[k], camera);
    find_cells(frame.rgbd[k].color, maps[k + 1], static_cast<std::uint8_t>(k + 1), threshold,
               camera);
  });
  layers.nearest.resize(width_, height_);
  layers.farthest.resize(width_, height_);
  for_rows(height_, [&](Rows rows) {
    const Rect part{0, rows.first, width_, rows.last - rows.first};
    layers.nearest.fill(part, {});
    layers.farthest.fill(part, {});
    for (const Camera& camera : cameras_) {
      if (camera.vertices.empty()) continue;
      for (const std::vector<DrawnCell>& band : camera.cells) {
        for (const DrawnCell& cell : band) {
          if (cell.top < rows.last && cell.bottom > rows.first) diminish::draw(cell, rows, layers);
        }
      }
    }
  });
}

/// Those that are joined and face the colour camera.
void SeenLayersDrawer::find_cells(ImageView<Bgr> picture, const ColorMap& map, std::uint8_t source,
                                  const sdct::Threshold& threshold, Camera& camera) const {
  const Image<LayerVertex>& vertices = camera.vertices;
  for (std::vector<DrawnCell>& band : camera.cells) band.clear();
  for_rows(vertices.height(), [&](Rows rows) {
    std::vector<DrawnCell>& cells = camera.cells[rows.band];
    for (int y = rows.first; y < std::min(rows.last, vertices.height() - 1); ++y) {
      const LayerVertex* const upper = vertices.row(y);
      const LayerVertex* const lower = vertices.row(y + 1);
      for (int x = 0; x + 1 < vertices.width(); ++x) {
        const Cell cell = {upper + x, upper + x + 1, lower + x, lower + x + 1};
        if (!is_drawn(cell, threshold)) continue;
        DrawnCell drawn = bounds_of(cell, {0, 0, width_, height_});
        if (drawn.left >= drawn.right || drawn.top >= drawn.bottom) continue;
        const Eigen::Array3f color = color_around(picture, upper[x].u, upper[x].v);
        const auto full = [&](float small) {
          return (small + 0.5F) * static_cast<float>(shrinkage_) - 0.5F;
        };
        drawn.surface.color = to_color(map(color, full(upper[x].x), full(upper[x].y)));
        drawn.surface.source = source;
        cells.push_back(drawn);
      }
    }
  });
}

void SeenLayersDrawer::find_vertices(const RgbdFrame& images,
                                     const RigidTransform& color_from_depth, Camera& camera) const {
  const ImageView<std::uint16_t> depth = images.depth;
  const int step = camera.step;
  camera.depth.resize(depth.width() / step, depth.height() / step);
  for (int y = 0; y < camera.depth.height(); ++y) {
    const std::uint16_t* const row = depth.row(y * step);
    for (int x = 0; x < camera.depth.width(); ++x) {
      camera.depth(x, y) = row[std::ptrdiff_t{x} * step];
    }
  }
  camera.visible.find(camera.depth, color_from_depth, color_bounds_);
  const Rect blocks = camera.visible.bounds();
  camera.vertices.resize(camera.depth.width(), camera.depth.height());
  const VertexRows::Frame frame{camera.depth,
                                camera.no_depth_mask,
                                camera.no_color_mask,
                                FloatTransform(color_from_depth),
                                camera.visible.blocks(),
                                blocks.x,
                                blocks.width};
  const float scale = 1.F / static_cast<float>(shrinkage_);
  for_rows(camera.vertices.height(), [&](Rows rows) {
    VertexRow& row = camera.row[rows.band];
    row.resize(blocks.width * VertexRow::block);
    for (int y = rows.first; y < rows.last; ++y) {
      LayerVertex* const vertices = camera.vertices.row(y);
      std::fill_n(vertices, camera.vertices.width(), LayerVertex{});
      const int block_row = y / BlockSet::height;
      if (block_row < blocks.y || block_row >= blocks.bottom()) continue;
      camera.rows.project(frame, y, row);
      const int first = blocks.x * VertexRow::block;
      const int last = std::min(camera.vertices.width(), blocks.right() * VertexRow::block);
      for (int x = first; x < last; ++x) {
        const auto i = static_cast<std::size_t>(x - first);
        if (!(row.inverse_z[i] > 0)) continue;
        const float z = 1 / row.inverse_z[i];
        const auto small = [&](std::int32_t subpixels) {
          return (static_cast<float>(subpixels) / sdct::subpixels + 0.5F) * scale - 0.5F;
        };
        vertices[x] = {small(row.x[i]), small(row.y[i]),     z,
                       row.depth_m[i],  row.u_over_z[i] * z, row.v_over_z[i] * z};
      }
    }
  });
}

}  // namespace diminish
