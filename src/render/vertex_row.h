#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "depth/visible_blocks.h"
#include "diminish/frame_set.h"
#include "diminish/image.h"
#include "diminish/rig.h"
#include "geometry/projection.h"
#include "geometry/ray_table.h"

namespace diminish {

/// Where in the picture some vertices lie; right and bottom are beyond it. Joining two is four
/// comparisons, without branches.
struct VertexBounds {
  int left = std::numeric_limits<int>::max(), top = left;
  int right = std::numeric_limits<int>::min(), bottom = right;

  bool empty() const { return left >= right; }
  Rect rect() const { return empty() ? Rect{} : Rect{left, top, right - left, bottom - top}; }
  bool overlaps(const Rect& part) const {
    return left < part.right() && right > part.x && top < part.bottom() && bottom > part.y;
  }
  friend VertexBounds join(const VertexBounds& a, const VertexBounds& b) {
    return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
            std::max(a.bottom, b.bottom)};
  }
};

/// The vertices of one row of a depth image (see MeshVertex), with one array for each value.
/// Vertices are processed in blocks. There is one more block than the row needs, of invalid
/// vertices.
struct VertexRow {
  static constexpr int block = BlockSet::width;

  std::vector<std::int32_t> x, y;         ///< in the colour camera's image, in 1/256 pixels
  std::vector<float> depth_m;             ///< z in the depth sensor's frame
  std::vector<float> inverse_z;           ///< 1 / z in the colour camera's frame; 0: not a vertex
  std::vector<float> u_over_z, v_over_z;  ///< place in the RGB-D camera's colour image, over z
  std::vector<VertexBounds> bounds;       ///< of each block's valid vertices

  void resize(int width);
};

/// Turns rows of one RGB-D camera's depth images into vertices by rule 1 of sdct.h. The result
/// equals DepthMesh's bit for bit.
class VertexRows {
 public:
  VertexRows(const RgbdCamera& camera, const Intrinsics& color);

  struct Frame {
    ImageView<std::uint16_t> depth;
    const Mask& depth_mask;
    const Mask& color_mask;
    FloatTransform to_color;
    const BlockSet& visible;  ///< other blocks are skipped
    int first_block, blocks;  ///< of a row: those that are wanted; vertices are counted from there
  };
  /// The vertices of one row. Those without a colour are none.
  void project(const Frame& frame, int row, VertexRow& vertices) const;

  int width() const { return rays_->width(); }
  int height() const { return rays_->height(); }

  /// Input of the kernels.
  struct Constants {
    Projection color, rgbd_color;
    FloatTransform to_rgbd_color;
    float unit_m, last_column, last_row;
  };

 private:
  /// Whether color_ray may not be a pixel's own, for a block of a row.
  bool may_have_holes(ImageView<std::uint16_t> depth, int first, int row) const;

  std::shared_ptr<const RayTable> rays_;
  Constants constants_;
};

}  // namespace diminish
