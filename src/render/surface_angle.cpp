#include <cmath>
#include <numbers>

#include "diminish/reconstruction.h"

namespace diminish {

double smallest_visible_surface_angle_deg(double distance_m, double pixel_angle_deg,
                                          double threshold_m) {
  constexpr double degree = std::numbers::pi / 180;
  const double pixel_spacing_m = distance_m * std::tan(pixel_angle_deg * degree);
  return std::atan2(pixel_spacing_m, threshold_m) / degree;
}

}  // namespace diminish
