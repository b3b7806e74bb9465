#pragma once

#include "diminish/image.h"

namespace diminish {

/// Averages inverse depths over the surface that they lie on, in widening steps (edge-avoiding
/// a-trous: Dammertz et al. 2010). Pixels count in pairs on both sides of the middle, and only if
/// both are near to it: a plane, whose inverse depth is linear in the picture, stays as it is, and
/// so does an edge.
class PlaneSmoothing {
 public:
  /// tolerance: differences from which on two pixels do not belong together. widest_px: reach of
  /// the last step, a power of two. Cost: 2 ns per pixel and step, shared by threads.
  void smooth(float tolerance, int widest_px, Image<float>& inverse_depth);

 private:
  Image<float> between_;
};

}  // namespace diminish
