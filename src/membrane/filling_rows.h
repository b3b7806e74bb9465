#pragma once

#include <Eigen/Core>
#include <span>

#include "diminish/image.h"

// What SmoothFilling does to a row of cells, on vector instructions.
namespace diminish::filling_rows {

/// The channels, and 1; all 0 for what is not there, so that sums count their terms.
using Color = Eigen::Array4f;
/// Columns [first, last) of a row.
struct Run {
  int first, last;
};

/// Sets the black cells (x + y is odd) of the runs of row y to the bilinear mean of the coarser
/// grid's cells, as far as those are there; and single cells of either colour, which may have no
/// neighbour to be relaxed from. near, far: the coarser grid's rows around this one. Rows are
/// indexed by x.
void interpolate(std::span<const Run> runs, int y, const Color* near, const Color* far,
                 Color* here);
/// Moves the cells where x + y + parity is even towards the mean of their neighbours, `factor`
/// times as far; by a factor of 1 whatever they were before.
void relax(std::span<const Run> runs, int y, int parity, float factor, const Color* above,
           const Color* below, Color* here);
/// Rounds `count` colours to levels.
void round(const Color* colors, int count, Bgr* pixels);

/// The same, cell by cell, bit for bit.
namespace plain {
void interpolate(std::span<const Run> runs, int y, const Color* near, const Color* far,
                 Color* here);
void relax(std::span<const Run> runs, int y, int parity, float factor, const Color* above,
           const Color* below, Color* here);
void round(const Color* colors, int count, Bgr* pixels);
}  // namespace plain

}  // namespace diminish::filling_rows
