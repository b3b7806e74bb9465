#pragma once

#include <algorithm>

#include "diminish/image.h"
#include "diminish/options.h"

namespace diminish {

/// The width that the options give it, pixels. has_shadows: where the shadow outside is gone, too,
/// the camera's picture is another, and there is no rim.
inline int soft_rim_width_px(const Options& options, bool has_shadows) {
  if (has_shadows && options.remove_shadows) return 0;
  return std::min(options.soft_rim_px, options.mask_margin_px / 2);
}

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
