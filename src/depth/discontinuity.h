#pragma once

#include <algorithm>

namespace diminish::sdct {

/// Points nearer to the camera than this are not drawn.
inline constexpr float near_plane_m = 0.01F;

/// The step-discontinuity constraint on the depths (in the depth sensor's frame).
///
/// The paper's threshold is constant. Depth sensors' resolution and noise, and the steps along a
/// surface seen at an angle, grow with the distance, the former with its square (Khoshelham &
/// Elberink 2012): beyond `1 / inverse_reach` the threshold does, too.
struct Threshold {
  float constant_m;
  float inverse_reach;  ///< 1/m; 0: constant

  Threshold(double constant, double reach_m)
      : constant_m(static_cast<float>(constant)),
        inverse_reach(reach_m > 0 ? static_cast<float>(1 / reach_m) : 0.F) {}
  float at(float depth_m) const {
    const float relative = depth_m * inverse_reach;
    return std::max(1.F, relative * relative) * constant_m;
  }
};
inline bool joined(float z0_m, float z1_m, float z2_m, const Threshold& threshold) {
  const float nearest = std::min({z0_m, z1_m, z2_m});
  return std::max({z0_m, z1_m, z2_m}) - nearest < threshold.at(nearest);
}

}  // namespace diminish::sdct
