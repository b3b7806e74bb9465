#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "diminish/image.h"

namespace diminish {

/// Keeps colours of a row for the next frame: with alpha 255 where they are invented, as a bar's
/// are (provenance::estimated), else 0.
void keep_inventions(const Bgr* colors, const std::uint8_t* provenance, int count, Bgra* kept);

/// What the last frame kept inside `part`, which is not empty.
struct EarlierInventions {
  const Image<Bgra>& picture;
  Rect part;
};

/// Neighbours in a row, whose places in the last frame lie evenly.
struct InventionRun {
  static constexpr int most = 32;
  Eigen::Vector2f first;  ///< place of the first one; less than 2^22 pixels away
  Eigen::Vector2f step;   ///< to the next one's
  int count;              ///< at most `most`
};

/// Mixes each colour with what the last frame showed at its place, bilinearly, if all of the four
/// pixels around it are in `part` and were invented. earlier_share: 1/256.
void mix_inventions(const EarlierInventions& earlier, const InventionRun& run, int earlier_share,
                    Bgr* colors);

}  // namespace diminish
