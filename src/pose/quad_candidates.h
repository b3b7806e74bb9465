#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "pose/dark_components.h"

namespace diminish {

/// Corners of something that may be a marker, clockwise (y down), in the full picture's pixels;
/// right to a few of them.
using Quad = std::array<Eigen::Vector2d, 4>;

/// Finds the components whose outline is a convex quadrilateral.
class QuadCandidates {
 public:
  const std::vector<Quad>& find(const DarkComponents& components);

 private:
  struct Point {
    int x, y;
  };
  void find_hull(const DarkComponents& components, const DarkComponents::Component& component);
  bool reduce_to_quad(Quad& quad);

  std::vector<Point> points_, hull_;
  std::vector<Quad> quads_;
};

}  // namespace diminish
