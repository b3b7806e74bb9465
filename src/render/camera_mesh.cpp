#include "render/camera_mesh.h"

#include <algorithm>

#include "render/cell_rasterizer.h"

namespace diminish {
namespace {

/// Whole blocks of cells that cannot touch the region are skipped. The rows' bounds are those of
/// cells.
void draw_cells_between(const VertexRow& upper, const VertexRow& lower,
                        const CameraMesh::Input& input, const Rect& part, SurfaceBuffer& surface) {
  const auto blocks = static_cast<int>(upper.bounds.size()) - 1;
  for (int block = 0; block < blocks; ++block) {
    const VertexBounds& above = upper.bounds[static_cast<std::size_t>(block)];
    const VertexBounds& below = lower.bounds[static_cast<std::size_t>(block)];
    // Most blocks of a row are drawn in other parts.
    if (std::min(above.top, below.top) >= part.bottom() ||
        std::max(above.bottom, below.bottom) <= part.y) {
      continue;
    }
    const VertexBounds both = join(above, below);
    if (!both.overlaps(part) || !input.region.touches(intersect(both.rect(), part))) continue;
    draw_cells(upper, lower, block, input.threshold, surface);
  }
}

}  // namespace

void CameraMesh::begin(const Input& input) {
  begin(static_cast<const Rect&>(input.region));
  visible_.find(input.depth, input.color_from_depth, input.region);
  const Rect blocks = visible_.bounds();
  first_row_ = blocks.y * BlockSet::height;
  row_count_ = std::min(blocks.bottom() * BlockSet::height, rows_.height()) - first_row_;
  if (blocks.empty()) row_count_ = 0;
  if (vertices_.size() < static_cast<std::size_t>(row_count_)) {
    vertices_.resize(static_cast<std::size_t>(row_count_));
    row_bounds_.resize(vertices_.size());
  }
  const VertexRows::Frame frame{
      input.depth,       input.depth_mask, input.color_mask, FloatTransform(input.color_from_depth),
      visible_.blocks(), blocks.x,         blocks.width};
  for_rows(row_count_, [&](Rows rows) {
    for (int i = rows.first; i < rows.last; ++i) {
      VertexRow& row = vertices_[static_cast<std::size_t>(i)];
      row.resize(blocks.width * VertexRow::block);
      rows_.project(frame, first_row_ + i, row);
      VertexBounds& all = row_bounds_[static_cast<std::size_t>(i)];
      all = {};
      // A block's cells reach into the next block.
      for (std::size_t block = 0; block + 1 < row.bounds.size(); ++block) {
        all = join(all, row.bounds[block]);
        row.bounds[block] = join(row.bounds[block], row.bounds[block + 1]);
      }
    }
  });
}

void CameraMesh::draw(const Input& input, Rows rows) {
  SurfaceBuffer& surface = surfaces_[rows.band];
  const Rect part = part_of(rows);
  surface.clear(part, input.region);
  for (int i = 0; i + 1 < row_count_; ++i) {
    const auto upper = static_cast<std::size_t>(i);
    if (join(row_bounds_[upper], row_bounds_[upper + 1]).overlaps(part)) {
      draw_cells_between(vertices_[upper], vertices_[upper + 1], input, part, surface);
    }
  }
  for (int y = part.y; y < part.bottom(); ++y) {
    input.region.for_each_gap(y, [&](int from, int to) {
      float* row = surface.inverse_z.data() + surface.row(y) - part.x;
      std::fill(row + from, row + to, 0.F);
    });
  }
}

void CameraMesh::take(const RemoteLayer& layer, const TiledRegion& region, Rows rows) {
  SurfaceBuffer& surface = surfaces_[rows.band];
  const Rect part = part_of(rows);
  surface.clear(part, region);
  for (int y = part.y; y < part.bottom(); ++y) {
    std::copy_n(layer.inverse_z.row(y - layer.region.y), part.width,
                surface.inverse_z.data() + surface.row(y));
  }
}

}  // namespace diminish
