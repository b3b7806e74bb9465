#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "geometry/cross.h"

namespace diminish {

/// Finds the corners of the convex hull, in order (Andrew 1979): with y downwards, clockwise. Sorts
/// `points`.
inline void find_convex_hull(std::vector<Eigen::Vector2d>& points,
                             std::vector<Eigen::Vector2d>& hull) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  hull.clear();
  const auto add_chain = [&hull](auto begin, auto end) {
    const std::size_t start = hull.size();
    for (auto point = begin; point != end; ++point) {
      while (hull.size() >= start + 2 &&
             cross(hull.back() - hull[hull.size() - 2], *point - hull.back()) <= 0) {
        hull.pop_back();
      }
      hull.push_back(*point);
    }
    if (!hull.empty()) hull.pop_back();  // the other chain begins with it
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
}

}  // namespace diminish
