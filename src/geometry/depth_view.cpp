#include "geometry/depth_view.h"

#include <utility>

namespace diminish {

bool DepthView::is_in_gap(const Eigen::Vector3f& point_m, float tolerance,
                          float tolerance_m) const {
  if (depth_.empty()) return false;
  const Eigen::Vector3f point = transform(depth_from_color_, point_m);
  const auto pixel = project(lens_, point);
  if (!pixel || !depth_.bounds().contains(pixel->x, pixel->y)) return false;
  const auto here = at(pixel->x, pixel->y, point.z());
  if (!here || here->measured_m != 0) return false;
  bool is_nearer = false;
  bool is_farther = false;
  // Rows first: neighbours in memory.
  for (const auto& [dx, dy] :
       {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
    int x = pixel->x + dx;
    int y = pixel->y + dy;
    for (int i = 0; i < gap_reach && depth_.bounds().contains(x, y); ++i, x += dx, y += dy) {
      if (depth_(x, y) == 0) continue;
      const float measured_m = unit_m_ * static_cast<float>(depth_(x, y));
      is_nearer = is_nearer || (1 - tolerance) * measured_m - tolerance_m < point.z();
      is_farther = is_farther || (1 + tolerance) * measured_m + tolerance_m > point.z();
      break;
    }
    if (is_nearer && is_farther) return true;
  }
  return false;
}

}  // namespace diminish
