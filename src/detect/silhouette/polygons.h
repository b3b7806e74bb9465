#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// Polygons in a picture. Whole numbers decide which pixels they cover, so all implementations set
/// the same ones, and neighbours with a common edge neither overlap nor leave gaps. Corners are
/// rounded to 1/256 pixel. An edge crosses the rows from its upper end to just before its lower
/// one. A pixel is inside if an odd number of edges cross its row at its centre or left of it.
struct Polygons {
  static constexpr int subpixels = 256;

  struct Corner {
    std::int32_t x, y;  ///< in subpixels
  };
  struct Polygon {
    std::uint32_t end;     ///< index after its last corner; it begins where the one before ends
    std::uint32_t object;  ///< its object
  };

  std::vector<Corner> corners;
  std::vector<Polygon> polygons;

  void clear() {
    corners.clear();
    polygons.clear();
  }

  /// Adds a corner; begins a polygon if none is open.
  void add_corner(const Eigen::Vector2d& pixel) {
    // Far outside any picture; products of differences still fit into 53 bits.
    static constexpr double largest_px = 65536;
    const auto rounded = [](double px) {
      const double within_px = std::clamp(px, -largest_px, largest_px);
      return static_cast<std::int32_t>(std::lrint(within_px * subpixels));
    };
    corners.push_back({rounded(pixel.x()), rounded(pixel.y())});
  }
  void end_polygon(std::uint32_t object) {
    polygons.push_back({static_cast<std::uint32_t>(corners.size()), object});
  }

  /// The first row whose pixels' centres are at y, in subpixels, or below it.
  static int row_from(std::int32_t y) {
    static_assert(subpixels == 1 << 8);
    return (y + subpixels - 1) >> 8;
  }

  std::uint32_t begin_of(std::size_t polygon) const {
    return polygon > 0 ? polygons[polygon - 1].end : 0;
  }

  /// The part of the picture outside which no pixel is inside.
  Rect bounds(const Rect& picture) const {
    // Corners may be far outside.
    int left = picture.right();
    int top = picture.bottom();
    int right = picture.x;
    int bottom = picture.y;
    for (const Corner& corner : corners) {
      left = std::min(left, corner.x / subpixels - 1);
      top = std::min(top, corner.y / subpixels - 1);
      right = std::max(right, corner.x / subpixels + 1);
      bottom = std::max(bottom, corner.y / subpixels + 1);
    }
    if (left >= right || top >= bottom) return {};
    return intersect({left, top, right - left, bottom - top}, picture);
  }
};

/// Rows [first, last) of a picture that a polygon may cover.
struct PolygonRows {
  int first = 0;
  int last = 0;

  PolygonRows(const Polygons& all, std::size_t polygon, int height) {
    const auto begin = all.corners.begin() + all.begin_of(polygon);
    const auto end = all.corners.begin() + all.polygons[polygon].end;
    if (begin == end) return;
    const auto by_y = [](const auto& a, const auto& b) { return a.y < b.y; };
    const auto [top, bottom] = std::minmax_element(begin, end, by_y);
    // An edge that ends at a row's centre does not cross it.
    first = std::clamp(Polygons::row_from(top->y), 0, height);
    last = std::clamp(Polygons::row_from(bottom->y), first, height);
  }
};

}  // namespace diminish
