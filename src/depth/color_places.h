#pragma once

#include <cstdint>

#include "diminish/rig.h"
#include "geometry/projection.h"

namespace diminish {

/// Where an RGB-D camera's colour sensor sees what its depth sensor sees.
class ColorPlaces {
 public:
  explicit ColorPlaces(const RgbdCamera& camera);

  /// A pixel of the colour image.
  struct Place {
    int column, line;  ///< not in its outermost two pixels; -1, -1 where it is not in the image
    bool exists() const { return column >= 0; }
  };
  /// Of the point at depth_m along the ray (x, y, 1) of a depth pixel.
  Place at(float ray_x, float ray_y, float depth_m) const;
  /// The same for several points, on vector instructions. columns, lines: room for `count` and a
  /// vector (16).
  void find(const float* ray_x, const float* ray_y, const float* depth_m, int count,
            std::int32_t* columns, std::int32_t* lines) const;

  /// Input of the kernel.
  struct Constants {
    FloatTransform to_color;
    Projection color;
    float end_column, end_line;  ///< of the inner part
  };

 private:
  Constants constants_;
};

}  // namespace diminish
