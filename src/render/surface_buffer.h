#pragma once

#include <cstddef>
#include <vector>

#include "diminish/image.h"
#include "diminish/tiled_region.h"
#include "render/vertex_row.h"

namespace diminish {

/// The nearest surface in each pixel of a region, before its colour is looked up. 1 / z, u / z and
/// v / z are linear in the picture.
struct SurfaceBuffer {
  static constexpr int rows_beyond = 2;  ///< there is room for
  Rect region;
  std::ptrdiff_t pitch = 0;      ///< from one row to the next; vectors may reach past a row's end
  std::vector<float> inverse_z;  ///< 0 where there is nothing
  std::vector<float> u_over_z, v_over_z;

  /// Makes the wanted pixels of `part`, rows of the wanted rectangle, empty. Undefined: where the
  /// surface is in others, and its u and v where there is nothing.
  void clear(const Rect& part, const TiledRegion& wanted);
  std::ptrdiff_t row(int y) const { return (y - region.y) * pitch; }
};

/// The number of pixels that are drawn of [first, last) of a row, columns of the picture.
int count_drawn(const SurfaceBuffer& surface, int y, int first, int last);

}  // namespace diminish
