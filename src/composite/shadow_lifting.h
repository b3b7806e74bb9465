#pragma once

#include <vector>

#include "diminish/image.h"
#include "diminish/reconstruction.h"

namespace diminish {

/// Takes the shadows away that the objects to remove cast (Reconstruction::light).
class ShadowLifting {
 public:
  /// How far inside the mask's rim the shadow comes back.
  static constexpr int fading_px = 12;

  /// Lights up all of the region, inside and outside the mask.
  void lift(const Reconstruction& reconstruction, Image<Bgr>& picture) const;
  /// Gives what is outside the mask back to the camera. The shadow comes back over the last pixels
  /// before the mask's rim, too, so that no line shows where it goes on outside.
  void restore_outside(const Image<Bgr>& camera, const Mask& occlusion,
                       const Reconstruction& reconstruction, Image<Bgr>& picture);

 private:
  void measure_distances(const Mask& occlusion, const Rect& part);

  std::vector<std::uint8_t> padded_[2];  ///< a row of each thread
  Image<std::uint8_t> distances_;        ///< to the mask's rim, at most `fading_px`
};

}  // namespace diminish
