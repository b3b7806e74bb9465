#include "pose/marker_agreement.h"

#include <algorithm>

#include "pose/known_markers.h"
#include "pose/marker_pose.h"

namespace diminish {
namespace {

Eigen::Vector2d center(const std::array<Eigen::Vector2d, 4>& corners) {
  return (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
}

}  // namespace

MarkerAgreement::MarkerAgreement(const Rig& rig, const Scene& scene)
    : rig_(rig), color_lens_(rig.color), sizes_m_(known_marker_sizes(scene)) {
  for (const RgbdCamera& camera : rig.rgbd) sensor_lenses_.emplace_back(camera.color);
}

void MarkerAgreement::find(const FrameSet& frame, const Markers& markers, const Poses& poses,
                           std::vector<std::optional<MarkerShift>>& by_camera) const {
  by_camera.assign(rig_.rgbd.size(), std::nullopt);
  for (std::size_t k = 0; k < std::min(rig_.rgbd.size(), markers.rgbd.size()); ++k) {
    if (!poses.color_from_depth[k]) continue;
    if (!frame.rgbd[k].has_picture() && !frame.rgbd[k].is_remote()) continue;
    const RigidTransform color_from_sensor =
        *poses.color_from_depth[k] * rig_.rgbd[k].color_from_depth.inverse();
    for (const Marker& seen : markers.rgbd[k]) {
      const auto size_m = sizes_m_.find(seen.id);
      const Marker* const in_color = find_marker(markers.color, seen.id);
      if (size_m == sizes_m_.end() || !in_color) continue;
      const auto pose = estimate_marker_pose(seen.corners, size_m->second, sensor_lenses_[k]);
      if (!pose) continue;
      // The centre is where it is for either pose that explains a square.
      const auto located =
          color_lens_.project(color_from_sensor * pose->camera_from_marker.translation);
      if (!located) continue;
      const double shift = (*located - center(in_color->corners)).norm() / rig_.color.fx;
      if (!by_camera[k] || shift > by_camera[k]->shift) by_camera[k] = {seen.id, shift};
    }
  }
}

}  // namespace diminish
