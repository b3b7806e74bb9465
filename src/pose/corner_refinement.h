#pragma once

#include <Eigen/Core>
#include <array>

#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// Moves the corners of a dark square on a light ground to sub-pixel accuracy. Along each side the
/// strongest dark-to-light step is located on short profiles across it; a line is fitted to these
/// points in undistorted rays, where sides are straight, and neighbouring lines are intersected.
/// modules: the number of cells along a side, with the border; a profile reaches no further than
/// the border is wide. Corners whose sides cannot be found stay as they are.
void refine_corners(const Image<std::uint8_t>& gray, const Lens& lens, int modules,
                    std::array<Eigen::Vector2d, 4>& corners);

}  // namespace diminish
