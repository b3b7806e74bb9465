#pragma once

#include <Eigen/Core>
#include <array>

#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// How `refine_corners` looks.
struct RefinementPass {
  int profiles;     ///< across each side
  double reach_px;  ///< how far from the side, in and out
  double step_px;   ///< between a profile's samples
  bool expect_outliers;
};
/// For corners that are some pixels off, then for what is left.
inline constexpr RefinementPass coarse_pass{14, 12, 1, true};
inline constexpr RefinementPass middle_pass{12, 6, 1, true};
inline constexpr RefinementPass fine_pass{48, 4, 0.5, false};

/// Moves the corners of a dark square on a light ground, clockwise, to sub-pixel accuracy. Along
/// each side the strongest dark-to-light step is located on short profiles across it; a line is
/// fitted to these points in undistorted rays, where sides are straight, and neighbouring lines are
/// intersected.
/// Only the green channel is looked at, the sharpest and least noisy one of most cameras.
/// modules: the number of cells along a side, with the border; a profile reaches no further than
/// the border is wide. Answers whether all four sides were found; else the corners stay as they
/// are.
bool refine_corners(const Image<Bgr>& image, const Lens& lens, int modules,
                    const RefinementPass& pass, std::array<Eigen::Vector2d, 4>& corners);

}  // namespace diminish
