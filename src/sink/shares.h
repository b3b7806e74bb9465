#pragma once

#include <string>

#include "diminish/diminished_frame.h"

namespace diminish {

/// Where the pixels of the objects' mask come from, as shares that add up to 1; all 0 without a
/// mask.
struct Shares {
  double seen = 0;       ///< by an RGB-D camera now; the witnessed ones too
  double witnessed = 0;  ///< of the whole mask
  double remembered = 0;
  double estimated = 0;  ///< seen without depth
  double invented = 0;
};

Shares shares_of(std::size_t mask_pixels, std::size_t valid_pixels, std::size_t witnessed_pixels,
                 std::size_t remembered_pixels, std::size_t estimated_pixels);

/// "truly seen 62 % (witnessed 20 %), remembered 31 %, invented 7 %"; what there is none of is left
/// out, but for the first and the last.
std::string to_text(const Shares& shares, int digits = 0);

}  // namespace diminish
