#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace diminish {

/// How much of the light a shadow may leave.
inline constexpr float deepest_shadow = 0.35F;

/// The factor that brings `color` nearest to `seen`, from the deepest shadow to `brightest`: a
/// surface in a shadow has not changed. Channels in levels.
inline float light_between(const Eigen::Array3f& seen, const Eigen::Array3f& color,
                           float brightest) {
  return std::clamp((seen * color).sum() / std::max(1.F, color.square().sum()), deepest_shadow,
                    brightest);
}

}  // namespace diminish
