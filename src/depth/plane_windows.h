#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "depth/depth_noise.h"

// What DepthSmoothing does to a row of a depth image, on vector instructions: planes through the
// depths in a window around each pixel.
namespace diminish::plane_windows {

/// A window's pixels on each side of its middle.
inline constexpr int reach = 3;
inline constexpr int side = 2 * reach + 1;

/// Of a row of windows, each in an array of its own: the plane's depth in the middle, how much it
/// grows per column and per row (in the image's units), and the depths' variance about it, as a
/// multiple of what the sensor's usual noise (DepthNoise) would make there.
struct Planes {
  float *depth, *slope_x, *slope_y, *variance;
};

struct Depths {
  const std::uint16_t* row;  ///< `reach` more rows, `pitch` pixels apart, and columns on each side
  std::ptrdiff_t pitch;
  int count;
  float unit_m;  ///< of a depth step
  DepthNoise noise;
};

/// Fits planes to the windows around a row's pixels by least squares. A window with a depth edge or
/// a hole, whose depth is 0, has a large variance. scratch: 3 (count + 2 reach).
void fit(const Depths& depths, const Planes& planes, double* scratch);

/// Some windows of a row, from the column `first` on, relative to that of the first pixel: at least
/// -reach. They end at most `reach` columns behind the last pixel.
struct Windows {
  Planes planes;
  int first, count;
};
/// Windows, weighed: sums of their weights, of the weighted depths that their planes have at a
/// pixel's column, and of the weighted slopes along columns.
struct Sums {
  float *weight, *depth, *slope;
};
/// For each of `count` pixels, sums up the windows in its row that reach it. A window whose
/// variance is `half_variance` has half of the weight. sums: may be the planes' memory. scratch: 4
/// (count + 2 reach).
void add_up(const Windows& windows, float half_variance, int count, const Sums& sums,
            float* scratch);

/// Sums of the rows from `first` on, relative to that of the pixels.
struct Around {
  std::array<Sums, side> rows;
  int first, count;
};
/// Of the measured depth, beside the windows' weights (1 each): what no window fits stays.
inline constexpr float own_weight = 0.1F;
/// Writes the weighted mean of what all windows around a pixel and its own depth say. 0 stays 0.
void mix(const Around& around, int count, std::uint16_t* depth);

}  // namespace diminish::plane_windows
