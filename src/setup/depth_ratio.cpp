#include "setup/depth_ratio.h"

#include <cmath>
#include <limits>

#include "core/robust.h"
#include "pose/marker_pose.h"

namespace diminish {
namespace {

std::optional<DepthRatio> of_pose(const RigidTransform& depth_from_marker, double size_m,
                                  const Lens& depth_lens, double depth_unit_m,
                                  const Image<std::uint16_t>& depth) {
  constexpr int places = 9;  // per side
  constexpr std::size_t least_places = places * places / 2 + 1;
  std::vector<double> ratios;
  for (int row = 0; row < places; ++row) {
    for (int column = 0; column < places; ++column) {
      const Eigen::Vector3d on_marker(((column + 0.5) / places - 0.5) * size_m,
                                      ((row + 0.5) / places - 0.5) * size_m, 0);
      const Eigen::Vector3d p = depth_from_marker * on_marker;
      const auto pixel = depth_lens.project(p);
      if (!pixel) continue;
      const auto x = static_cast<int>(std::lround(pixel->x()));
      const auto y = static_cast<int>(std::lround(pixel->y()));
      if (!depth.bounds().contains(x, y) || depth(x, y) == 0) continue;
      ratios.push_back(depth(x, y) * depth_unit_m / p.z());
    }
  }
  if (ratios.size() < least_places) return std::nullopt;
  DepthRatio result;
  result.ratio = median(ratios);
  for (double& ratio : ratios) ratio = std::abs(ratio - result.ratio);
  result.spread = median(ratios) / result.ratio;
  return result;
}

}  // namespace

std::optional<DepthRatio> measure_depth_ratio(const Marker& marker, double size_m,
                                              const RgbdCamera& camera,
                                              const Image<std::uint16_t>& depth) {
  const Lens depth_lens(camera.depth);
  const auto pose = estimate_marker_pose(marker.corners, size_m, Lens(camera.color));
  if (!pose) return std::nullopt;
  const RigidTransform depth_from_color = camera.color_from_depth.inverse();
  const auto best = of_pose(depth_from_color * pose->camera_from_marker, size_m, depth_lens,
                            camera.depth_unit_m, depth);
  if (!pose->is_doubtful()) return best;
  const auto other =
      of_pose(depth_from_color * pose->alternative, size_m, depth_lens, camera.depth_unit_m, depth);
  if (!best || (other && other->spread < best->spread)) return other;
  return best;
}

}  // namespace diminish
