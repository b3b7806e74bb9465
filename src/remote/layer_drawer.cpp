#include "remote/layer_drawer.h"

#include <algorithm>

#include "blend/cell_resolution.h"
#include "blend/confidence_grid.h"
#include "render/texture_lookup.h"

namespace diminish {
namespace {

/// Any but 0.
constexpr std::uint8_t own_source = 1;

}  // namespace

LayerDrawer::LayerDrawer(const RgbdCamera& camera, const Intrinsics& color)
    : depth_(camera, color), mesh_(camera, color), color_(color) {}

void LayerDrawer::draw(const RgbdFrame& images, const RemoteDrawing& drawing, RemoteLayer& layer) {
  const Rect& region = drawing.region;
  depth_.clean(images, drawing.color_from_depth, {drawing.rgbd_color, drawing.rgbd_depth},
               drawing.region, drawing.options, cleaned_);
  const CameraMesh::Input input{cleaned_,
                                drawing.rgbd_depth,
                                drawing.rgbd_color,
                                drawing.color_from_depth,
                                drawing.region,
                                sdct::Threshold(drawing.options.discontinuity_threshold_m,
                                                drawing.options.discontinuity_reach_m)};
  mesh_.begin(input);
  for_rows(
      region.height, [&](Rows rows) { mesh_.draw(input, rows); }, CameraMesh::band_px);
  layer.region = region;
  layer.color.resize(region.width, region.height);
  layer.inverse_z.resize(region.width, region.height);
  for_rows(
      region.height, [&](Rows rows) { write_rows(images.color, rows, layer); },
      CameraMesh::band_px);
  measure_cells(layer);
}

void LayerDrawer::write_rows(ImageView<Bgr> texture, Rows rows, RemoteLayer& layer) {
  Scratch& scratch = scratch_[rows.band];
  const int width = layer.region.width;
  const auto size = static_cast<std::size_t>(width);
  scratch.source.resize(size);
  scratch.depth_m.resize(size);
  scratch.colors.resize(size);
  for (int i = rows.first; i < rows.last; ++i) {
    const int y = layer.region.y + i;
    const SurfaceRow row(mesh_.surface(y), y, own_source);
    std::copy_n(row.inverse_z, size, layer.inverse_z.row(i));
    for (std::size_t x = 0; x < size; ++x) {
      const bool is_drawn = row.inverse_z[x] > 0;
      scratch.source[x] = is_drawn ? own_source : 0;
      scratch.depth_m[x] = is_drawn ? 1 / row.inverse_z[x] : 0;
    }
    look_up_colors(row, texture, width, scratch.source.data(), scratch.depth_m.data(),
                   scratch.colors.data());
    Bgr* const color = layer.color.row(i);
    for (std::size_t x = 0; x < size; ++x) {
      const Bgra& found = scratch.colors[x];
      // What memory held before does not travel.
      color[x] = scratch.source[x] != 0 ? Bgr{found.b, found.g, found.r} : Bgr{};
    }
  }
}

void LayerDrawer::measure_cells(RemoteLayer& layer) const {
  ConfidenceGrid grid;
  grid.begin(layer.region, color_, 0);
  layer.resolution.resize(grid.columns(), grid.rows());
  for (int i = 0; i < grid.rows(); ++i) {
    const Rect first = grid.cell(0, i);
    const int top = layer.region.y + first.y;
    const int bottom = layer.region.y + first.bottom() - 1;
    const SurfaceRow upper(mesh_.surface(top), top, own_source);
    const SurfaceRow lower(mesh_.surface(bottom), bottom, own_source);
    for (int j = 0; j < grid.columns(); ++j) {
      const Rect cell = grid.cell(j, i);
      const bool is_drawn = upper.inverse_z[cell.x] > 0 && upper.inverse_z[cell.right() - 1] > 0 &&
                            lower.inverse_z[cell.x] > 0;
      layer.resolution(j, i) = is_drawn ? cell_resolution(upper, lower, cell) : 0.F;
    }
  }
}

}  // namespace diminish
