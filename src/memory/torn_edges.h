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
  /// Inside the objects' mask, in a part of the picture. Cost: 0.1 us per pixel in a gap.
  void close(const View& view, const Mask& objects, const Rect& part, Reconstruction& drawn);

 private:
  /// Of the nearest drawn pixel in a direction; 0 if the gap is wide. x, y: in the part.
  float depth_beside(const Reconstruction& drawn, int x, int y, int dx, int dy) const;
  /// The keyframe's colour at a point, if that is on its surface.
  std::optional<Bgr> look(const View& view, const Eigen::Vector3f& x_in_color) const;
  void close_at(const View& view, int x, int y, Reconstruction& drawn) const;

  Intrinsics color_;
  KeyframeGrid grid_;
  std::shared_ptr<const RayTable> rays_;  ///< found when they are needed
  Rect part_;
  Mask gaps_;  ///< of the part: 1 where nothing was drawn
};

}  // namespace diminish
