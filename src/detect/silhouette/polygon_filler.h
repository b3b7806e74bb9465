#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "detect/silhouette/polygons.h"
#include "diminish/image.h"

namespace diminish {

/// Fills polygons.
class PolygonFiller {
 public:
  /// Sets the pixels inside to 255 and leaves the others alone. covers: by object, set to 1 where
  /// one of its polygons covers a pixel.
  void fill(const Polygons& polygons, Mask& mask, std::span<std::uint8_t> covers);

 private:
  void list_columns(std::span<const Polygons::Corner> corners, const PolygonRows& rows,
                    const Rect& picture);
  bool fill_row(int row, std::uint8_t* pixels);

  std::vector<int> columns_;  ///< the first at or right of each edge, row by row
  std::vector<int> ends_;     ///< end of each row's columns
};

}  // namespace diminish
