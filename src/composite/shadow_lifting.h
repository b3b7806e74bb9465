#pragma once

#include <vector>

#include "core/rows.h"
#include "diminish/image.h"
#include "diminish/surfaces.h"

namespace diminish {

/// Removes the shadows that the objects to remove cast (Surfaces::light).
class ShadowLifting {
 public:
  /// Over this distance inside the mask's rim the shadow returns.
  static constexpr int fading_px = 12;

  /// Lifts the shadows in all of the region, inside and outside the mask.
  void lift(const Surfaces& surfaces, Image<Bgr>& picture) const;
  /// Restores the camera's picture outside the mask. The shadow returns over the last pixels before
  /// the mask's rim, so that no line shows where it continues outside.
  void restore_outside(ImageView<Bgr> camera, const Mask& occlusion, const Surfaces& surfaces,
                       Image<Bgr>& picture);

 private:
  void measure_distances(const Mask& occlusion, const Rect& part);

  std::vector<std::uint8_t> padded_[most_bands];  ///< a row of each band
  Image<std::uint8_t> distances_;                 ///< to the mask's rim, at most `fading_px`
};

}  // namespace diminish
