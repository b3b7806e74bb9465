#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/rows.h"
#include "depth/depth_part.h"
#include "diminish/image.h"
#include "diminish/rig.h"
#include "diminish/tiled_region.h"
#include "geometry/projection.h"

namespace diminish {

/// Some of a depth image's blocks.
class BlockSet {
 public:
  static constexpr int width = 16, height = 8;  ///< of a block, pixels

  void resize(int columns, int rows) {
    columns_ = columns;
    set_.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  }
  /// For each block along a row of pixels, whether it is in the set.
  const std::uint8_t* row(int y) const { return set_.data() + index(0, y / height); }
  std::uint8_t& operator()(int column, int row) { return set_[index(column, row)]; }
  std::uint8_t operator()(int column, int row) const { return set_[index(column, row)]; }
  void clear() { std::fill(set_.begin(), set_.end(), std::uint8_t{0}); }

  /// Columns and rows of blocks.
  int columns() const { return columns_; }
  int rows() const { return static_cast<int>(set_.size()) / std::max(1, columns_); }
  /// Of a block, row by row.
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

 private:
  int columns_ = 0;
  std::vector<std::uint8_t> set_;
};

/// The blocks of a depth image that may be visible in a region of the colour camera's picture. A
/// block's rays, between its least and its greatest depth, span a convex body. The block is out of
/// view if all of that body lies beyond one of the planes through the camera and the region's
/// sides, or within none of its tiles. Blocks that are left out show nothing there, and neither
/// does a triangle with a vertex in one.
class VisibleBlocks {
 public:
  static constexpr int width = BlockSet::width, height = BlockSet::height;

  VisibleBlocks(const RgbdCamera& camera, const Intrinsics& color);

  /// color_from_depth: from the depth sensor's frame to the colour camera's. further_px: so much
  /// further than the region reaches. Cost: 1 ns per pixel.
  void find(ImageView<std::uint16_t> depth, const RigidTransform& color_from_depth,
            const TiledRegion& region, int further_px = 0);
  /// The same where each pixel may show anything between two depths.
  void find(float nearest_m, float farthest_m, const RigidTransform& color_from_depth,
            const Rect& region);
  /// Nothing is visible.
  void clear();

  const BlockSet& blocks() const { return visible_; }
  /// The box of these blocks, counted in blocks.
  const Rect& bounds() const { return bounds_; }
  /// From the first to the last visible block of each row, plus one block on all sides.
  const DepthPart& part() const { return part_; }

 private:
  struct Range {
    float least, greatest;
  };
  /// The rays (x, y, 1) of a block's pixels and of those next to it.
  struct Rays {
    Range x, y;
  };
  /// Those of a camera, by block.
  struct BlockRays {
    explicit BlockRays(const Intrinsics& depth);
    std::vector<Rays> of_block;
  };
  /// Of the columns of a row of blocks.
  struct Depths {
    std::vector<std::uint16_t> nearest, farthest;
  };
  /// In the depth sensor's frame; positive beyond a side of the region.
  struct Plane {
    float x, y, z, offset;
  };
  struct Sides {
    std::array<Plane, 4> planes;
    std::size_t count = 0;
  };

  /// Adds the planes through the camera and the left and right (axis 0) or the upper and lower
  /// sides of a rectangle in the picture, if all points of the side have rays.
  void add_sides(const Rect& rectangle, int axis, Sides& sides) const;
  void begin(const RigidTransform& color_from_depth, const Rect& region);
  static bool is_inside(const Sides& sides, const Rays& rays, const Range& depth_m);
  bool touches(const TiledRegion& region, int further_px, const Rays& rays,
               const Range& depth_m) const;
  void find_part();

  Lens color_;
  Projection projection_;  ///< the same
  float unit_m_;
  int image_width_, image_height_;
  std::shared_ptr<const BlockRays> rays_;
  RigidTransform color_from_depth_;
  FloatTransform to_color_{RigidTransform{}};  ///< the same
  Sides sides_;
  Depths depths_[most_bands];
  std::vector<Range> depth_m_;  ///< by block
  BlockSet visible_;
  Rect bounds_;
  DepthPart part_;
};

}  // namespace diminish
