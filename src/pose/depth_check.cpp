#include "pose/depth_check.h"

#include <cmath>

namespace diminish {

std::optional<MarkerDepth> depth_at(const Eigen::Vector3d& x_in_depth, const Lens& depth_lens,
                                    ImageView<std::uint16_t> depth, double depth_unit_m) {
  const auto pixel = depth_lens.project(x_in_depth);
  if (!pixel) return std::nullopt;
  const auto x = static_cast<int>(std::lround(pixel->x()));
  const auto y = static_cast<int>(std::lround(pixel->y()));
  if (!depth.bounds().contains(x, y) || depth(x, y) == 0) return std::nullopt;
  return MarkerDepth{depth(x, y) * depth_unit_m, x_in_depth.z()};
}

MarkerDepths marker_depths(const RigidTransform& depth_from_marker, double size_m,
                           const Lens& depth_lens, ImageView<std::uint16_t> depth,
                           double depth_unit_m) {
  constexpr int places = 9;  // per side
  static_assert(std::size_t{places} * places == MarkerDepths::most);
  MarkerDepths depths;
  for (int row = 0; row < places; ++row) {
    for (int column = 0; column < places; ++column) {
      const Eigen::Vector3d on_marker(((column + 0.5) / places - 0.5) * size_m,
                                      ((row + 0.5) / places - 0.5) * size_m, 0);
      const auto at = depth_at(depth_from_marker * on_marker, depth_lens, depth, depth_unit_m);
      if (at) depths.values[depths.count++] = *at;
    }
  }
  if (depths.count * 2 < MarkerDepths::most) depths.count = 0;
  return depths;
}

std::optional<double> marker_depth_error_m(const RigidTransform& depth_from_marker, double size_m,
                                           const Lens& depth_lens, ImageView<std::uint16_t> depth,
                                           double depth_unit_m) {
  return median_over_marker(
      marker_depths(depth_from_marker, size_m, depth_lens, depth, depth_unit_m),
      [](const MarkerDepth& at) { return std::abs(at.measured_m - at.computed_m); });
}

}  // namespace diminish
