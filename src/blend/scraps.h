#pragma once

#include <cstdint>

#include "core/connected_regions.h"
#include "depth/discontinuity.h"
#include "diminish/image.h"
#include "diminish/reconstruction.h"

namespace diminish {

/// Removes small pieces that hang in the air by themselves from the scene as it was drawn: where an
/// RGB-D camera mixed the depths of two surfaces, or measured one in a mirror.
class Scraps {
 public:
  /// A piece is smaller than a square whose side is the picture's width by this. Depth images have
  /// about as many columns for every picture.
  static constexpr int squares_across = 64;

  /// A piece is what is connected without a step between neighbouring pixels; its pixels inside the
  /// mask go. surroundings: the mask's box and what is around it, where a piece may go on. Cost: 8
  /// instructions a pixel of these.
  void remove(const Mask& occlusion, const Rect& surroundings, const sdct::Threshold& step,
              Reconstruction& reconstruction);

  /// How a drawn pixel goes on to its right; 0: it was not drawn.
  enum Link : std::uint8_t { bare, linked, last };

 private:
  void find_pieces(const Rect& part, const sdct::Threshold& step, const Image<float>& depth_m);

  Mask links_;  ///< of the part's pixels
  ConnectedRegions pieces_;
};

}  // namespace diminish
