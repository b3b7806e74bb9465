#pragma once

#include <vector>

#include "diminish/image.h"
#include "memory/color_votes.h"

namespace diminish {

inline int squared_difference(const Bgr& a, const Bgr& b) {
  const int db = a.b - b.b;
  const int dg = a.g - b.g;
  const int dr = a.r - b.r;
  return db * db + dg * dg + dr * dr;
}

/// Moves the edges of a coarse depth image to the edges of the picture that it belongs to. Near an
/// edge, a place takes the depth of that side whose colours, further from the edge, are more like
/// its own.
class ColorEdges {
 public:
  /// colors: of the picture, at the places that have depth. inverse_depth: 1 / z; 0: unknown.
  /// Cost: 5 ns a place, and 0.1 us one near an edge.
  void align(const Image<Bgr>& colors, Image<float>& inverse_depth);

 private:
  void find_band(const Image<float>& inverse_depth);
  void sample(const Image<Bgr>& colors, const Image<float>& inverse_depth);
  VoteSamples samples_around(int x, int y) const;

  Image<float> before_;
  Mask steps_, across_;  ///< 1 at a step; near one in the same row
  Mask band_;            ///< 1 near one
  std::vector<float> row_far_, row_near_;
  // Of blocks of places: the least and the greatest 1 / z (0: unknown) in it and those beside it,
  // and a sample. Samples have a margin, where nothing is known.
  Image<float> far_, near_;
  Image<float> inverse_z_, blue_, green_, red_;
};

}  // namespace diminish
