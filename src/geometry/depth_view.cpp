#include "geometry/depth_view.h"

#include <algorithm>
#include <cstddef>

namespace diminish {

bool DepthView::is_in_gap(const Depth& place, float tolerance, float tolerance_m) const {
  if (place.measured_m != 0) return false;
  bool is_nearer = false;
  bool is_farther = false;
  const std::uint16_t* const own = &depth_(place.x, place.y);
  const auto row = depth_.stride() / std::ptrdiff_t{sizeof(*own)};
  struct Way {
    std::ptrdiff_t step;
    int pixels;
  };
  // Rows first: neighbours in memory.
  for (const auto& [step, pixels] : {Way{1, depth_.width() - 1 - place.x}, Way{-1, place.x},
                                     Way{row, depth_.height() - 1 - place.y}, Way{-row, place.y}}) {
    const std::uint16_t* measured = own;
    int left = std::min(pixels, gap_reach);
    while (left > 0 && *(measured += step) == 0) --left;
    if (left == 0) continue;
    const float measured_m = unit_m_ * static_cast<float>(*measured);
    is_nearer = is_nearer || (1 - tolerance) * measured_m - tolerance_m < place.own_m;
    is_farther = is_farther || (1 + tolerance) * measured_m + tolerance_m > place.own_m;
    if (is_nearer && is_farther) return true;
  }
  return false;
}

}  // namespace diminish
