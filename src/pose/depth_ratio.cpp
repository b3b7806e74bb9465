#include "pose/depth_ratio.h"

#include <cmath>

#include "pose/depth_check.h"
#include "pose/marker_pose.h"

namespace diminish {
namespace {

std::optional<DepthRatio> of_pose(const RigidTransform& depth_from_marker, double size_m,
                                  const Lens& depth_lens, double depth_unit_m,
                                  ImageView<std::uint16_t> depth) {
  const MarkerDepths depths =
      marker_depths(depth_from_marker, size_m, depth_lens, depth, depth_unit_m);
  const auto ratio_at = [](const MarkerDepth& at) { return at.measured_m / at.computed_m; };
  const auto ratio = median_over_marker(depths, ratio_at);
  if (!ratio) return std::nullopt;
  const auto spread = median_over_marker(
      depths, [&](const MarkerDepth& at) { return std::abs(ratio_at(at) - *ratio); });
  return DepthRatio{*ratio, *spread / *ratio};
}

}  // namespace

std::optional<DepthRatio> measure_depth_ratio(const Marker& marker, double size_m,
                                              const RgbdCamera& camera,
                                              ImageView<std::uint16_t> depth) {
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
