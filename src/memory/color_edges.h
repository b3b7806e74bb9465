#pragma once

#include "diminish/image.h"

namespace diminish {

/// Moves the edges of a coarse depth image to the edges of the picture that it belongs to. Near an
/// edge, a place takes the depth of that side whose colours, further from the edge, are more like
/// its own.
class ColorEdges {
 public:
  /// inverse_depth: 1 / z at every `step`-th pixel of the picture; 0: unknown. Cost: 1 us per place
  /// near an edge.
  void align(ImageView<Bgr> picture, int step, Image<float>& inverse_depth);

 private:
  void find_band(const Image<float>& inverse_depth);

  Image<float> before_;
  Image<Bgr> colors_;
  Mask band_;  ///< 1 near an edge
};

}  // namespace diminish
