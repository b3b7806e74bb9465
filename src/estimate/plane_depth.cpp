#include "estimate/plane_depth.h"

#include <algorithm>
#include <array>

#include "core/rows.h"

namespace diminish {

void draw_planes(const std::vector<InversePlane>& planes, const Intrinsics& view,
                 double depth_unit_m, Image<std::uint16_t>& depth) {
  // Beyond it a depth does not fit into the image.
  const auto least = static_cast<float>(1 / (65535 * depth_unit_m));
  const auto unit = static_cast<float>(depth_unit_m);
  for_rows(view.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      std::uint16_t* const row = depth.row(y);
      // Along a row a plane's inverse depth changes evenly.
      struct Along {
        float first, step;
      };
      std::array<Along, most_planes> along{};
      std::size_t count = 0;
      for (const InversePlane& plane : planes) {
        if (count == along.size()) break;
        const Eigen::Vector2d ray(-view.cx / view.fx, (y - view.cy) / view.fy);
        along[count++] = {static_cast<float>(plane.inverse_depth(ray)),
                          static_cast<float>(plane.inverse.x() / view.fx)};
      }
      for (int x = 0; x < view.width; ++x) {
        float nearest = 0;
        for (std::size_t i = 0; i < count; ++i) {
          nearest = std::max(nearest, along[i].first + static_cast<float>(x) * along[i].step);
        }
        row[x] = nearest > least ? static_cast<std::uint16_t>(1 / (nearest * unit) + 0.5F) : 0;
      }
    }
  });
}

}  // namespace diminish
