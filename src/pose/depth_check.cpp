#include "pose/depth_check.h"

#include <cmath>

#include "core/robust.h"

namespace diminish {

std::vector<MarkerDepth> marker_depths(const RigidTransform& depth_from_marker, double size_m,
                                       const Lens& depth_lens, ImageView<std::uint16_t> depth,
                                       double depth_unit_m) {
  constexpr int places = 9;  // per side
  std::vector<MarkerDepth> depths;
  for (int row = 0; row < places; ++row) {
    for (int column = 0; column < places; ++column) {
      const Eigen::Vector3d on_marker(((column + 0.5) / places - 0.5) * size_m,
                                      ((row + 0.5) / places - 0.5) * size_m, 0);
      const Eigen::Vector3d x_in_depth = depth_from_marker * on_marker;
      const auto pixel = depth_lens.project(x_in_depth);
      if (!pixel) continue;
      const auto x = static_cast<int>(std::lround(pixel->x()));
      const auto y = static_cast<int>(std::lround(pixel->y()));
      if (!depth.bounds().contains(x, y) || depth(x, y) == 0) continue;
      depths.push_back({depth(x, y) * depth_unit_m, x_in_depth.z()});
    }
  }
  if (depths.size() * 2 < static_cast<std::size_t>(places * places)) depths.clear();
  return depths;
}

std::optional<double> marker_depth_error_m(const RigidTransform& depth_from_marker, double size_m,
                                           const Lens& depth_lens, ImageView<std::uint16_t> depth,
                                           double depth_unit_m) {
  std::vector<double> errors;
  for (const MarkerDepth& at :
       marker_depths(depth_from_marker, size_m, depth_lens, depth, depth_unit_m)) {
    errors.push_back(std::abs(at.measured_m - at.computed_m));
  }
  if (errors.empty()) return std::nullopt;
  return median(errors);
}

}  // namespace diminish
