#pragma once

#include <Eigen/Core>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// Border pixels, in order.
using Outline = std::vector<Eigen::Vector2i>;

/// Follows the outer border of the 8-connected region of 255 whose first pixel (highest row, then
/// leftmost) is `first`: its border pixels in order; where it is a pixel wide, on both ways.
void trace_outline(const Mask& mask, const Eigen::Vector2i& first, Outline& outline);

/// The area of the polygon through an outline's pixel centres.
double polygon_area(const Outline& outline);

}  // namespace diminish
