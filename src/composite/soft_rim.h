#pragma once

#include "diminish/image.h"

namespace diminish {

/// Lets a picture pass into the camera's within a mask's rim, so that it does not end in steps.
class SoftRim {
 public:
  /// Pixels of the mask that are d <= `width_px` from its outside become camera + d / (width_px +
  /// 1) (picture - camera). Distances are an octagon's; beyond the images' borders nothing is
  /// outside. box: the mask's bounding box. Cost: 0.1 ns a pixel of the mask's box and pixel of
  /// width.
  void blend(const Image<Bgr>& camera, const Mask& mask, const Rect& box, int width_px,
             Image<Bgr>& picture);

 private:
  void find_distances(const Mask& mask, const Rect& box, int width_px);

  Mask distance_;         ///< of the mask's box: up to width_px + 1
  Mask inside_, eroded_;  ///< of the box and a pixel more on each side
};

}  // namespace diminish
