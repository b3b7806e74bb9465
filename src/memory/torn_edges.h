#pragma once

#include <memory>
#include <optional>

#include "diminish/reconstruction.h"
#include "memory/keyframe.h"

namespace diminish {

/// Closes the narrow gaps that a drawn keyframe has where surfaces end: cells of its grid between
/// two surfaces are not drawn. A pixel in such a gap shows the nearer of the surfaces on both sides
/// that reaches so far: the keyframe's place that is nearest to the pixel is on it.
class TornEdges {
 public:
  TornEdges(const Intrinsics& color, const KeyframeGrid& grid);

  /// The keyframe. depth: what is drawn of it, on the grid.
  struct View {
    const Image<Bgr>& picture;
    const Image<std::uint16_t>& depth;
    FloatTransform keyframe_from_color;
  };
  /// Inside the objects' mask, in a part of the picture. Cost: a tenth of a ns a pixel, and 0.1 us
  /// one in a narrow gap.
  void close(const View& view, const Mask& objects, const TiledRegion& part, Reconstruction& drawn);

 private:
  /// The keyframe's colour at a point, if that is on its surface.
  std::optional<Bgr> look(const View& view, const Eigen::Vector3f& x_in_color) const;
  /// Pixels [first, last) along a row or column of the picture, between two that are drawn.
  struct Gap {
    Pixel before, first, after;
    int count;
  };
  void close_gap(const View& view, const Mask& objects, const Gap& gap,
                 Reconstruction& drawn) const;
  void close_pixel(const View& view, const Pixel& pixel, float z_m, Reconstruction& drawn) const;
  void close_along_row(const View& view, const Mask& objects, int y, Reconstruction& drawn) const;
  /// Those that end above a row.
  void close_along_columns(const View& view, const Mask& objects, int y,
                           Reconstruction& drawn) const;
  /// The furthest that a pixel in a gap may be from those that are drawn.
  int reach_px() const { return 2 * grid_.step(); }

  Intrinsics color_;
  KeyframeGrid grid_;
  std::shared_ptr<const RayTable> rays_;  ///< found when they are needed
  TiledRegion part_;
  Mask open_;  ///< of the part: 1 where nothing was drawn
};

}  // namespace diminish
