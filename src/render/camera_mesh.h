#pragma once

#include <vector>

#include "core/rows.h"
#include "depth/visible_blocks.h"
#include "diminish/remote_images.h"
#include "diminish/rig.h"
#include "diminish/tiled_region.h"
#include "render/sdct.h"
#include "render/surface_buffer.h"
#include "render/vertex_row.h"

namespace diminish {

/// One RGB-D camera's mesh, drawn in bands of the region's rows, which different threads may draw
/// at the same time.
class CameraMesh {
 public:
  /// The least height of a band: cells that reach into two bands are set up twice.
  static constexpr int band_px = 64;

  CameraMesh(const RgbdCamera& camera, const Intrinsics& color)
      : rows_(camera, color), visible_(camera, color) {}

  /// What is to be drawn.
  struct Input {
    const Image<std::uint16_t>& depth;
    const Mask& depth_mask;
    const Mask& color_mask;
    const RigidTransform& color_from_depth;
    const TiledRegion& region;
    sdct::Threshold threshold;
  };

  /// Finds the vertices. Call before drawing the bands.
  void begin(const Input& input);
  /// rows: counted from the region's first one.
  void draw(const Input& input, Rows rows);

  /// Instead of both: takes what another machine has drawn of this region. The surface has no
  /// texture then.
  void take(const RemoteLayer& layer, const TiledRegion& region, Rows rows);
  /// Call before taking the bands.
  void begin(const Rect& region) { region_ = region; }

  /// That holds a row of the picture.
  SurfaceBuffer& surface(int y) { return surfaces_[band_of(y)]; }
  const SurfaceBuffer& surface(int y) const { return surfaces_[band_of(y)]; }

 private:
  std::size_t band_of(int y) const {
    return static_cast<std::size_t>((y - region_.y) / band_height(region_.height, band_px));
  }
  Rect part_of(Rows rows) const {
    return {region_.x, region_.y + rows.first, region_.width, rows.last - rows.first};
  }

  VertexRows rows_;
  VisibleBlocks visible_;
  Rect region_;
  int first_row_ = 0, row_count_ = 0;     ///< of the depth image: those that may be visible
  std::vector<VertexRow> vertices_;       ///< of these rows
  std::vector<VertexBounds> row_bounds_;  ///< likewise: where in the picture they lie
  SurfaceBuffer surfaces_[most_bands];
};

}  // namespace diminish
