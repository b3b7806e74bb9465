#pragma once

#include <cstdint>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// Finds what stands in front of the holes in a picture. A hole beside the edge of a thing in front
/// belongs to what is behind, which the thing hides from the RGB-D cameras.
///
/// Each row and column of a hole has a pixel at either end. If the depths of both were measured and
/// differ more than they do along a surface, the nearer one stands in front.
class FarSide {
 public:
  /// In `codes`.
  struct Place {
    int x, y;
  };

  struct Input {
    const Image<std::uint8_t>& codes;  ///< of a part of the picture
    Rect part;                         ///< that part
    std::uint8_t hole;                 ///< the code of the holes' pixels
    std::uint8_t open_bit;             ///< set in the codes of pixels that are not known
    ImageView<float> depth_m;          ///< of the picture; 0: not measured
    Rect measured;                     ///< where `depth_m` is valid
  };
  /// Returns the known pixels that stand in front, some of them twice. Valid until the next call.
  /// Cost: one pass over the codes, and a few operations for each run of a hole.
  const std::vector<Place>& find_front(const Input& input);

 private:
  std::vector<Place> front_;
  std::vector<std::uint8_t> is_below_;  ///< by column: whether a hole goes on, below `above_`
  std::vector<int> above_;              ///< by column: the row above it
};

}  // namespace diminish
