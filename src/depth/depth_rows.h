#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "depth/depth_noise.h"
#include "geometry/projection.h"

// What DepthCleaner does to a row of a depth image, on vector instructions.
namespace diminish::depth_rows {

/// Pixels on both sides that flying pixels depend on.
inline constexpr int reach = 2;

/// A row of a depth image, or a part of it.
struct Row {
  const std::uint16_t* depth;
  int count;
  float unit_m;  ///< of a depth step
  DepthNoise noise;
};

/// Sets those pixels of `result` to 0 that lie beside a depth edge and do not continue the surface
/// on their other side. row.depth: `reach` rows, `pitch` pixels apart, and `reach` more columns on
/// each side.
void remove_flying(const Row& row, std::ptrdiff_t pitch, std::uint16_t* result);

/// A row of depth pixels as the colour sensor sees it, to its side and ahead of it: a point is in
/// its picture at x / z.
struct Places {
  const float* ray_x;  ///< of each pixel
  const float* ray_y;
  FloatTransform to_color;
};
/// Places increase along a row, except where something near reaches over what is behind it. Sets
/// pixels to 0 that are less than `margin` from something more than `threshold_m` nearer. depth_m,
/// place: scratch memory of `count` + 16.
void remove_hidden(const Places& places, float unit_m, float margin, float threshold_m, int count,
                   std::uint16_t* depth, float* depth_m, float* place);

/// Rows are searched for gaps in blocks of this many pixels.
inline constexpr int piece = 16;

/// For each whole block of a row, whether two depths more than `limit` apart lie at one of its
/// pixels and one of the next `steps` ones, `step` apart.
void find_jumps(const std::uint16_t* depth, int count, std::ptrdiff_t step, int steps,
                std::uint16_t limit, std::uint8_t* has_jump);

/// When two depths, in an image's units, belong to two surfaces: how far apart they must be,
/// including their noise.
struct Gap {
  float least, constant, by_square;

  int is_between(int a, int b) const {  // 1 or 0, so that it can be vectorised
    const auto nearer = static_cast<float>(std::min(a, b));
    const float wide = std::max(least, constant + by_square * nearer * nearer);
    return static_cast<float>(std::abs(a - b)) > wide ? 1 : 0;
  }
};
/// Clears the flags (0 or 1) of pixels that do not have two depths with a gap between them within
/// `reach`. depth: `reach` rows, `pitch` pixels apart, and `reach` more columns on each side.
void keep_gaps(const std::uint16_t* depth, std::ptrdiff_t pitch, int count, const Gap& gap,
               std::uint8_t* flags);

/// Copies the depths of a row that are not masked; the others become 0.
void leave_out(const std::uint16_t* depth, const std::uint8_t* mask, int count,
               std::uint16_t* result);

/// For each of `count` columns, the bits that are set in any of some rows (at least one).
void unite(std::span<const std::uint8_t* const> rows, int count, std::uint8_t* result);

}  // namespace diminish::depth_rows
