#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/connected_regions.h"

namespace diminish {

/// Corners of something that may be a marker, clockwise (y down), in the full picture's pixels;
/// right to a few of them.
using Quad = std::array<Eigen::Vector2d, 4>;

/// Finds the regions whose outline is a convex quadrilateral.
class QuadCandidates {
 public:
  const std::vector<Quad>& find(const ConnectedRegions& regions);

 private:
  struct Point {
    int x, y;
  };
  void find_hull(const ConnectedRegions& regions, const ConnectedRegions::Region& region);
  bool reduce_to_quad(Quad& quad);

  std::vector<Point> points_, hull_;
  std::vector<Quad> quads_;
};

}  // namespace diminish
