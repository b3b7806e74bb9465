#pragma once

#include <vector>

#include "diminish/image.h"
#include "reconstruct/vertex_row.h"

namespace diminish {

/// The nearest surface in each pixel of a region, before its colour is looked up. Linear in the
/// picture are 1 / z, u / z and v / z.
struct SurfaceBuffer {
  struct Sample {
    float inverse_z, u_over_z, v_over_z;  ///< inverse_z: 0 where there is nothing
  };
  Rect region;
  std::vector<Sample> samples;  ///< row by row, region.width apart

  void clear(const Rect& region);
  const Sample* row(int y) const {
    return samples.data() + static_cast<std::ptrdiff_t>(y - region.y) * region.width;
  }
};

/// Draws the cells between 16 vertices of two neighbouring rows and the vertices beside and below
/// them (rules 2 to 5 of sdct.h), all cells at a time: whether a pixel lies in one of a cell's
/// triangles is decided for 16 cells at once. Large cells are drawn one by one.
void draw_cells(const VertexRow& upper, const VertexRow& lower, int block, float threshold_m,
                SurfaceBuffer& surface);

}  // namespace diminish
