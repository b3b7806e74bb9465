#pragma once

#include <algorithm>

#include "core/rows.h"
#include "diminish/image.h"
#include "diminish/options.h"

namespace diminish {

/// The rim's width with these options, pixels. has_shadows: if the shadow outside is also removed,
/// the camera's picture differs from ours, and there is no soft rim.
inline int soft_rim_width_px(const Options& options, bool has_shadows) {
  if (has_shadows && options.remove_shadows) return 0;
  return std::min(options.soft_rim_px, options.mask_margin_px / 2);
}

/// Blends a picture into the camera's within a mask's rim, so that it does not end in steps.
class SoftRim {
 public:
  /// Pixels of the mask at a distance d <= `width_px` from its outside become camera + d /
  /// (width_px + 1) (picture - camera). Distances are octagonal; beyond the image's border nothing
  /// is outside. box: the mask's bounding box. Cost: 0.1 ns per pixel of the box and pixel of
  /// width.
  void blend(ImageView<Bgr> camera, const Mask& mask, const Rect& box, int width_px,
             Image<Bgr>& picture);

 private:
  /// Of a band of rows, and of as many more on each side as its distances depend on.
  struct Scratch {
    Mask distance;  ///< up to width_px + 1
    Mask inside, eroded;
  };

  static void find_distances(const Mask& mask, const Rect& around, const Rect& box, int width_px,
                             Scratch& scratch);

  Scratch scratch_[most_bands];
};

}  // namespace diminish
