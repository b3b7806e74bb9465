#pragma once

#include "diminish/intrinsics.h"
#include "diminish/reconstruction.h"

namespace diminish {

namespace detail {
template <class Pixel>
void clear_outside(const Rect& region, const Rect& drawn, Image<Pixel>& image) {
  const Rect both = intersect(region, drawn);
  if (both.empty()) return image.fill(drawn, {});
  image.fill({drawn.x, drawn.y, drawn.width, both.y - drawn.y}, {});
  image.fill({drawn.x, both.y, both.x - drawn.x, both.height}, {});
  image.fill({both.right(), both.y, drawn.right() - both.right(), both.height}, {});
  image.fill({drawn.x, both.bottom(), drawn.width, drawn.bottom() - both.bottom()}, {});
}
}  // namespace detail

/// Gives a reconstruction its size and its region. Everything outside becomes empty; the region's
/// pixels are written later. Cost: clearing what the last region had and this one does not.
inline void clear_outside(const Intrinsics& color, const TiledRegion& region,
                          Reconstruction& reconstruction) {
  const bool same_size =
      reconstruction.color.width() == color.width && reconstruction.color.height() == color.height;
  if (same_size) {
    detail::clear_outside(region, reconstruction.region, reconstruction.color);
    detail::clear_outside(region, reconstruction.region, reconstruction.depth_m);
    detail::clear_outside(region, reconstruction.region, reconstruction.source);
  } else {
    // Of zeros.
    reconstruction.color = Image<Bgra>(color.width, color.height);
    reconstruction.depth_m = Image<float>(color.width, color.height);
    reconstruction.source = Image<std::uint8_t>(color.width, color.height);
  }
  reconstruction.region = region;
}

/// Makes room for a second camera's view if there will be one. Its pixels are written later.
inline void resize_second(bool blended, const Intrinsics& color, SecondView& second) {
  const int width = blended ? color.width : 0;
  const int height = blended ? color.height : 0;
  second.color.resize(width, height);
  second.source.resize(width, height);
  second.share.resize(width, height);
}

}  // namespace diminish
