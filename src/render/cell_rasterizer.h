#pragma once

#include <vector>

#include "diminish/image.h"
#include "render/sdct.h"
#include "render/vertex_row.h"

namespace diminish {

/// The nearest surface in each pixel of a region, before its colour is looked up. Linear in the
/// picture are 1 / z, u / z and v / z.
struct SurfaceBuffer {
  Rect region;
  std::ptrdiff_t pitch = 0;      ///< from a row to the next; vectors may reach over a row's end
  std::vector<float> inverse_z;  ///< 0 where there is nothing
  std::vector<float> u_over_z, v_over_z;

  int first_row = 0, last_row = -1;  ///< rows beyond these are empty

  void clear(const Rect& region);
  bool touches(int y) const { return y >= first_row && y <= last_row; }
  std::ptrdiff_t row(int y) const { return (y - region.y) * pitch; }
};

/// Puts what is nearer in `from` into the row of `into`.
void keep_nearest(const SurfaceBuffer& from, int y, SurfaceBuffer& into);

/// The pixels of a row that something is drawn in.
int count_drawn(const SurfaceBuffer& surface, int y);

/// Draws the cells between 16 vertices of two neighbouring rows and the vertices beside and below
/// them (rules 2 to 5 of sdct.h). Edges and planes of neighbouring cells are set up together; then
/// each cell is drawn as one quadrilateral, a vector of pixels at a time.
void draw_cells(const VertexRow& upper, const VertexRow& lower, int block,
                const sdct::Threshold& threshold, SurfaceBuffer& surface);

}  // namespace diminish
