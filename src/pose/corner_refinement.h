#pragma once

#include <Eigen/Core>
#include <array>

#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// Settings of `refine_corners`.
struct RefinementPass {
  int profiles;     ///< across each side
  double reach_px;  ///< how far from the side, in and out
  double step_px;   ///< between a profile's samples
  bool expect_outliers;
};
/// One for corners that are some pixels off, one for the final step.
inline constexpr RefinementPass coarse_pass{14, 12, 1, true};
inline constexpr RefinementPass middle_pass{12, 6, 1, true};
inline constexpr RefinementPass fine_pass{48, 4, 0.5, false};

/// Moves the corners of a dark square on a light ground, clockwise, to sub-pixel accuracy. Finds
/// the strongest dark-to-light step on short profiles across each side, fits a line to these points
/// in undistorted rays, where sides are straight, and intersects neighbouring lines. Uses only the
/// green channel, the sharpest and least noisy one of most cameras.
/// modules: the number of cells along a side, including the border; a profile is no longer than the
/// border is wide. Returns whether all four sides were found; otherwise the corners stay as they
/// are.
bool refine_corners(ImageView<Bgr> image, const Lens& lens, int modules, const RefinementPass& pass,
                    std::array<Eigen::Vector2d, 4>& corners);

}  // namespace diminish
