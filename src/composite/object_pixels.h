#pragma once

#include <algorithm>
#include <cstdint>

#include "diminish/diminished_frame.h"

namespace diminish {

namespace detail {
inline void resize_cleared(const Rect& size, const Rect& was_set, Image<std::uint8_t>& image) {
  if (image.bounds() == size) {
    image.fill(intersect(was_set, size), 0);
  } else {
    image = Image<std::uint8_t>(size.width, size.height);
  }
}
}  // namespace detail

/// Gives `result` the objects' mask and their box. Its provenance gets the size `origins`, and is
/// the camera's everywhere. Cost: the last frame's objects and this one's, not the picture.
inline void set_objects(const Mask& occlusion, const Rect& objects, const Rect& origins,
                        DiminishedFrame& result) {
  static_assert(provenance::camera == 0);
  detail::resize_cleared(occlusion.bounds(), result.objects, result.mask);
  detail::resize_cleared(origins, result.objects, result.provenance);
  result.objects = objects;
  for (int y = objects.y; y < objects.bottom(); ++y) {
    std::copy_n(occlusion.row(y) + objects.x, objects.width, result.mask.row(y) + objects.x);
  }
}

}  // namespace diminish
