#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "diminish/image.h"

namespace diminish {

enum class Connectivity { four, eight };

/// The connected regions of a mask's pixels of one value, found by uniting the runs of neighbouring
/// rows. Keeps its memory from one mask to the next.
class ConnectedRegions {
 public:
  /// The pixels [first, last) of row y.
  struct Run {
    int y, first, last;
    int region;  ///< index in `regions()`
  };
  struct Region {
    Rect box;
    int pixels = 0;
    Eigen::Vector2i first;  ///< the leftmost pixel of its highest row
  };

  /// The mask's pixels are 0 or 255.
  void find(const Mask& mask, std::uint8_t value, Connectivity connectivity);

  /// By row, then from left to right.
  const std::vector<Run>& runs() const { return runs_; }
  /// In the order of their first runs.
  const std::vector<Region>& regions() const { return regions_; }

 private:
  int root(int run);
  void number_regions();

  std::vector<Run> runs_;  ///< while they are united, `region` is another run of the region
  std::vector<Region> regions_;
};

using Outline = std::vector<Eigen::Vector2i>;

/// Follows the outer border of the 8-connected region of 255 whose first pixel (highest row, then
/// leftmost) is `first`: its border pixels in order; where it is a pixel wide, on both ways.
void trace_outline(const Mask& mask, const Eigen::Vector2i& first, Outline& outline);

/// The area of the polygon through an outline's pixel centres.
double polygon_area(const Outline& outline);

}  // namespace diminish
