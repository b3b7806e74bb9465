#pragma once

#include <cstdint>
#include <vector>

#include "detect/color_blob/smooth_picture.h"
#include "detect/color_blob/watershed.h"
#include "diminish/image.h"

namespace diminish {

/// Refines an object's outline from a small picture to full resolution. Reuses its memory.
class OutlineRefinement {
 public:
  /// The watershed of `image`'s colours between the inside and the outside of `region` (255 on the
  /// object, one pixel per `scale` image pixels), which lies in the small picture's `window`.
  /// Writes the object's pixels (255) and the others around it (0) to `object`, and returns where
  /// that lies in the image. The object's border is inside unless the image cuts it off. Cost:
  /// proportional to the outline's length, except for filling `object`.
  Rect refine(ImageView<Bgr> image, const Mask& region, const Rect& window, int scale,
              Mask& object);

 private:
  void find_band(const Mask& region, const Rect& box);
  void set_labels(int scale);
  void smooth_band(ImageView<Bgr> image, const Rect& part, int scale);
  void write_object(const Rect& part, const Rect& visible, Mask& object) const;
  std::uint8_t nearest_side(int pixel) const;

  Mask coarse_, inside_, not_outside_, scratch_;
  Mask cells_;  ///< labels of `scale` x `scale` pixels each
  Image<std::uint8_t> labels_;
  PictureSmoother smoother_;
  Image<Bgr> smooth_;  ///< in and next to the cells without a label
  Watershed watershed_;
};

}  // namespace diminish
