#include "pose/depth_scale.h"

#include <algorithm>
#include <cmath>

#include "pose/depth_ratio.h"
#include "pose/known_markers.h"

namespace diminish {
namespace {

/// Corners are found to about a fifth of a pixel: then a side's length is known to 1 %.
constexpr double shortest_side_px = 30;
/// Of the ratio over one marker: else the marker is not what was measured.
constexpr double largest_spread = 0.02;

double shortest_side(const Marker& marker) {
  double shortest = (marker.corners[0] - marker.corners[3]).norm();
  for (std::size_t i = 0; i + 1 < marker.corners.size(); ++i) {
    shortest = std::min(shortest, (marker.corners[i + 1] - marker.corners[i]).norm());
  }
  return shortest;
}

/// Twice as far is as wrong as half as far.
double error(double ratio) {
  return ratio > 0 ? std::abs(std::log(ratio)) : 0;
}

}  // namespace

DepthScale::DepthScale(const Rig& rig, const Scene& scene)
    : rig_(rig), sizes_m_(known_marker_sizes(scene)) {}

void DepthScale::find(const FrameSet& frame, const Markers& markers,
                      std::vector<std::optional<MarkerScale>>& by_camera) const {
  by_camera.assign(rig_.rgbd.size(), std::nullopt);
  for (std::size_t k = 0; k < std::min(rig_.rgbd.size(), markers.rgbd.size()); ++k) {
    by_camera[k] = find(frame, markers.rgbd[k], k);
  }
}

std::optional<MarkerScale> DepthScale::find(const FrameSet& frame, const std::vector<Marker>& seen,
                                            std::size_t camera) const {
  if (!rig_.rgbd[camera].measures_depth || !frame.rgbd[camera].takes_part()) return std::nullopt;
  std::optional<MarkerScale> worst;
  for (const Marker& marker : seen) {
    const auto size_m = sizes_m_.find(marker.id);
    if (size_m == sizes_m_.end() || shortest_side(marker) < shortest_side_px) continue;
    const auto found =
        measure_depth_ratio(marker, size_m->second, rig_.rgbd[camera], frame.rgbd[camera].depth);
    if (!found || found->spread > largest_spread) continue;
    if (!worst || error(found->ratio) > error(worst->ratio)) {
      worst = {marker.id, found->ratio};
    }
  }
  return worst;
}

}  // namespace diminish
