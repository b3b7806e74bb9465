#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "diminish/image.h"
#include "geometry/ray_table.h"

namespace diminish {

/// How far from a hole, in depth pixels.
inline constexpr float color_ray_shift = 0.6F;

/// The ray on which the colour of a depth pixel's point is looked up, as deep as the point: the
/// pixel's own; beside a hole, `color_ray_shift` further from it (rule 1 of sdct.h).
///
/// Where depth is missing, something ends, or something stands that depth sensors do not see. The
/// colour image shows half of it in the pixels beside the hole: its lens and its demosaicing spread
/// an edge, and depth and colour are registered to a pixel at best.
inline Eigen::Vector2f color_ray(ImageView<std::uint16_t> depth, const RayTable& rays, int column,
                                 int row) {
  Eigen::Vector2f ray = rays(column, row);
  // Nearly all pixels: there is depth on all sides.
  if (column > 0 && column + 1 < depth.width() && row > 0 && row + 1 < depth.height()) {
    const std::uint16_t* here = depth.row(row) + column;
    if (here[-1] != 0 && here[1] != 0 && depth(column, row - 1) != 0 &&
        depth(column, row + 1) != 0) {
      return ray;
    }
  }
  const auto is_hole = [&](int dx, int dy) {
    return depth.bounds().contains(column + dx, row + dy) && depth(column + dx, row + dy) == 0;
  };
  const int right = (is_hole(-1, 0) ? 1 : 0) - (is_hole(1, 0) ? 1 : 0);
  const int down = (is_hole(0, -1) ? 1 : 0) - (is_hole(0, 1) ? 1 : 0);
  Eigen::Vector2f result = ray;
  if (right != 0 && column + right >= 0 && column + right < depth.width()) {
    result += color_ray_shift * (rays(column + right, row) - ray);
  }
  if (down != 0 && row + down >= 0 && row + down < depth.height()) {
    result += color_ray_shift * (rays(column, row + down) - ray);
  }
  return result;
}

}  // namespace diminish
