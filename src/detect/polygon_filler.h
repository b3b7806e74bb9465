#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "detect/polygons.h"
#include "diminish/image.h"

namespace diminish {

/// Fills polygons.
class PolygonFiller {
 public:
  /// Sets the pixels inside to 255; leaves the others alone. covers: by object, becomes 1 where one
  /// of its polygons covers a pixel.
  void fill(const Polygons& polygons, Mask& mask, std::span<std::uint8_t> covers);

 private:
  bool fill_row(std::span<const Polygons::Corner> corners, int row, Mask& mask);

  std::vector<int> columns_;  ///< the first at or right of each edge, in a row
};

}  // namespace diminish
