#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "depth/depth_part.h"
#include "diminish/image.h"
#include "diminish/rig.h"

namespace diminish {

/// The blocks of a depth image that may be visible in a region of the colour camera's picture. A
/// block's rays, between its least and its greatest depth, span a convex body. The block is out of
/// view if all of that body lies beyond one of the planes through the camera and the region's
/// sides. Blocks that are left out show nothing there, and neither does a triangle with a vertex in
/// one.
class VisibleBlocks {
 public:
  static constexpr int width = 16, height = 8;  ///< pixels

  VisibleBlocks(const RgbdCamera& camera, const Intrinsics& color);

  /// color_from_depth: from the depth sensor's frame to the colour camera's. Cost: 1 ns per pixel.
  void find(ImageView<std::uint16_t> depth, const RigidTransform& color_from_depth,
            const Rect& region);
  /// Nothing is visible.
  void clear();

  /// For each block along a row of pixels, whether it may be visible.
  const std::uint8_t* row(int y) const { return visible_.data() + index(0, y / height); }
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
  /// Of the columns of a row of blocks.
  struct Depths {
    std::vector<std::uint16_t> nearest, farthest;
  };
  /// In the depth sensor's frame; positive beyond a side of the region.
  struct Plane {
    float x, y, z, offset;
  };

  void find_sides(const RigidTransform& color_from_depth, const Rect& region);
  bool is_visible(const Rays& rays, const Range& depth_m) const;
  void find_part();
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  Lens color_;
  float unit_m_;
  int image_width_, image_height_, columns_, rows_;
  std::vector<Rays> rays_;
  std::vector<Plane> sides_;
  Depths depths_[2];  ///< one per thread
  std::vector<std::uint8_t> visible_;
  DepthPart part_;
};

}  // namespace diminish
