#include "geometry/depth_view.h"

#include <utility>

namespace diminish {

bool DepthView::is_in_gap(const Depth& place, float tolerance, float tolerance_m) const {
  if (place.measured_m != 0) return false;
  bool is_nearer = false;
  bool is_farther = false;
  // Rows first: neighbours in memory.
  for (const auto& [dx, dy] :
       {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
    int x = place.x + dx;
    int y = place.y + dy;
    for (int i = 0; i < gap_reach && depth_.bounds().contains(x, y); ++i, x += dx, y += dy) {
      if (depth_(x, y) == 0) continue;
      const float measured_m = unit_m_ * static_cast<float>(depth_(x, y));
      is_nearer = is_nearer || (1 - tolerance) * measured_m - tolerance_m < place.own_m;
      is_farther = is_farther || (1 + tolerance) * measured_m + tolerance_m > place.own_m;
      break;
    }
    if (is_nearer && is_farther) return true;
  }
  return false;
}

}  // namespace diminish
