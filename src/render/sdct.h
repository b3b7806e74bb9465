#pragma once

#include <cstdint>

#include "depth/discontinuity.h"

namespace diminish::sdct {

// The rules of step-discontinuity constrained triangulation (Meerits & Saito 2015, section 3.3),
// stated once for every backend.
//
// 1. A depth pixel is a vertex if it has a measurement, lies on no object to remove, and its place
//    in the RGB-D camera's colour image exists and shows no object to remove. That place is where
//    the point lies or, beside a hole in the depth image, a little further from it (color_ray.h).
// 2. The four vertices of a 2x2 cell make two triangles:
//      (x, y), (x + 1, y), (x, y + 1)   and   (x + 1, y), (x + 1, y + 1), (x, y + 1).
// 3. A triangle is drawn if it has three vertices, `joined` says so, and `faces_forward`.
// 4. Vertices are rounded to 1/256 pixel; a pixel belongs to a triangle if its centre is inside, or
//    on a top or left edge. Neighbouring triangles so share no pixel and leave none out.
// 5. Of several surfaces in a pixel the nearest is seen.

/// Vertex positions are in units of 1 / subpixels.
inline constexpr int subpixel_bits = 8;
inline constexpr int subpixels = 1 << subpixel_bits;

/// Vertices further than this from the picture's origin are not drawn, so that products of
/// coordinates fit 64 bits with room to spare.
inline constexpr float max_coordinate_px = 32000.F;

/// Twice the signed area; positive if the colour camera sees the side that the depth sensor saw.
inline std::int64_t doubled_area(std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1,
                                 std::int64_t x2, std::int64_t y2) {
  return (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
}
inline bool faces_forward(std::int64_t doubled_area) {
  return doubled_area > 0;
}

}  // namespace diminish::sdct
