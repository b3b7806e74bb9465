#pragma once

#include <cstdint>
#include <vector>

#include "core/connected_regions.h"
#include "core/rows.h"
#include "diminish/image.h"

namespace diminish {

/// Finds the connected parts of a picture that are darker than their surroundings.
class DarkRegions {
 public:
  /// A pixel is dark if it is 7 % (and two levels) below the mean of the 5x5 pixels around it.
  /// Parts are 4-connected: a marker's corner often touches that of the shadow around its margin.
  const ConnectedRegions& find(const Image<std::uint8_t>& small);

 private:
  struct Run {
    int y, first, last;
  };
  struct Band {
    std::vector<std::uint16_t> column_sums;
    std::vector<std::uint8_t> dark;  ///< of a row
    std::vector<Run> runs;           ///< of dark pixels
  };
  Band bands_[most_bands];
  ConnectedRegions regions_;
};

}  // namespace diminish
