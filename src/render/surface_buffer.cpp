#include "render/surface_buffer.h"

#include <algorithm>

namespace diminish {

void SurfaceBuffer::clear(const Rect& part, const TiledRegion& wanted) {
  region = part;
  pitch = region.width + VertexRow::block;
  const int rows = region.height + rows_beyond;
  const auto size = static_cast<std::size_t>(pitch) * static_cast<std::size_t>(rows);
  for (std::vector<float>* values : {&inverse_z, &u_over_z, &v_over_z}) {
    if (values->size() < size) values->resize(size);
  }
  for (int y = region.y; y < region.bottom(); ++y) {
    float* const from = inverse_z.data() + row(y) - region.x;
    wanted.for_each_run(y, [&](int first, int last) { std::fill(from + first, from + last, 0.F); });
  }
}

int count_drawn(const SurfaceBuffer& surface, int y, int first, int last) {
  const float* const z = surface.inverse_z.data() + surface.row(y) - surface.region.x;
  int count = 0;
  for (int x = first; x < last; ++x) count += z[x] > 0 ? 1 : 0;
  return count;
}

}  // namespace diminish
