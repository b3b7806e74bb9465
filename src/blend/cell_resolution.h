#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "blend/confidence_grid.h"
#include "render/texture_lookup.h"

namespace diminish {

/// Pixels of an RGB-D camera's colour image for each of the picture, in a cell of ConfidenceGrid
/// whose corners are all drawn. upper, lower: the surface in the cell's first and last row.
inline float cell_resolution(const SurfaceRow& upper, const SurfaceRow& lower, const Rect& cell) {
  const auto place = [](const SurfaceRow& row, int x) {
    const float z = 1 / row.inverse_z[x];
    return Eigen::Vector2f(row.u_over_z[x] * z, row.v_over_z[x] * z);
  };
  const int right = cell.right() - 1;
  const Eigen::Vector2f origin = place(upper, cell.x);
  const Eigen::Vector2f along_x = place(upper, right) - origin;
  const Eigen::Vector2f along_y = place(lower, cell.x) - origin;
  const float area = along_x.x() * along_y.y() - along_x.y() * along_y.x();
  const int pixels = std::max(1, right - cell.x) * std::max(1, cell.height - 1);
  return std::max(area / static_cast<float>(pixels), ConfidenceGrid::least_resolution);
}

}  // namespace diminish
