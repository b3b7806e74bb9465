#include <map>
#include <string>
#include <vector>

#include "diminish/pose_source.h"
#include "pose/depth_check.h"
#include "pose/known_markers.h"
#include "pose/marker_pose.h"

namespace diminish {
namespace {

/// Poses from the world marker, found anew in every frame (the default).
class MarkerSource : public PoseSource {
 public:
  MarkerSource(const Rig& rig, const Scene& scene)
      : rig_(rig), world_marker_(scene.world_marker), color_lens_(rig.color) {
    if (rig.pose.exists()) rig.pose.expect_keys({"source"});
    if (!(world_marker_.size_m > 0)) {
      throw Error("scene.yaml: world_marker: expected {id, size_m}, needed by pose.source marker");
    }
    for (const RgbdCamera& camera : rig.rgbd) {
      rgbd_color_lenses_.emplace_back(camera.color);
      depth_lenses_.emplace_back(camera.depth);
    }
    other_marker_sizes_ = known_marker_sizes(scene);
    other_marker_sizes_.erase(world_marker_.id);  // it always agrees with itself
  }

  bool needs_markers() const override { return true; }

  void estimate(const FrameSet& frame, const Markers& markers, Poses& poses) override {
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      if (!frame.rgbd[k].has_picture() && !frame.rgbd[k].is_remote()) continue;
      if (const auto pose = world_pose(markers.rgbd[k], rgbd_color_lenses_[k], rig_.rgbd[k].name,
                                       poses.messages)) {
        poses.depth_from_world[k] = settle_by_depth(*pose, world_marker_.size_m, frame, k);
      }
    }
    if (const auto pose = world_pose(markers.color, color_lens_, "color", poses.messages)) {
      poses.color_from_world = settle_by_shared_markers(*pose, frame, markers, poses);
    }
  }

 private:
  std::optional<MarkerPose> world_pose(const std::vector<Marker>& markers, const Lens& lens,
                                       const std::string& camera,
                                       std::vector<std::string>& messages) const {
    const Marker* marker = find_marker(markers, world_marker_.id);
    std::optional<MarkerPose> pose;
    if (marker) pose = estimate_marker_pose(marker->corners, world_marker_.size_m, lens);
    if (!pose) {
      messages.push_back("world marker " + std::to_string(world_marker_.id) + " not visible in " +
                         camera);
    }
    return pose;
  }

  /// The depth sensor's pose in the marker's frame, from the solution that agrees with the measured
  /// depth.
  RigidTransform settle_by_depth(const MarkerPose& pose, double size_m, const FrameSet& frame,
                                 std::size_t k) const {
    const RigidTransform depth_from_color = rig_.rgbd[k].color_from_depth.inverse();
    RigidTransform best = depth_from_color * pose.camera_from_marker;
    if (!pose.is_doubtful()) return best;
    const RigidTransform alternative = depth_from_color * pose.alternative;
    const auto error = [&](const RigidTransform& depth_from_marker) {
      return marker_depth_error_m(depth_from_marker, size_m, depth_lenses_[k], frame.rgbd[k].depth,
                                  rig_.rgbd[k].depth_unit_m);
    };
    const auto best_error = error(best);
    const auto alternative_error = error(alternative);
    return best_error && alternative_error && *alternative_error < *best_error ? alternative : best;
  }

  /// The colour camera's solution under which it sees the other markers where the RGB-D cameras
  /// locate them.
  RigidTransform settle_by_shared_markers(const MarkerPose& pose, const FrameSet& frame,
                                          const Markers& markers, const Poses& poses) const {
    if (!pose.is_doubtful()) return pose.camera_from_marker;
    double best_error = 0;
    double alternative_error = 0;
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      if (!poses.depth_from_world[k]) continue;
      const RigidTransform world_from_depth = poses.depth_from_world[k]->inverse();
      for (const Marker& seen : markers.rgbd[k]) {
        const auto size = other_marker_sizes_.find(seen.id);
        const Marker* in_color = find_marker(markers.color, seen.id);
        if (size == other_marker_sizes_.end() || !in_color) continue;
        const auto rgbd_pose =
            estimate_marker_pose(seen.corners, size->second, rgbd_color_lenses_[k]);
        if (!rgbd_pose) continue;
        const RigidTransform world_from_marker =
            world_from_depth * settle_by_depth(*rgbd_pose, size->second, frame, k);
        best_error += marker_error_px(pose.camera_from_marker * world_from_marker, size->second,
                                      color_lens_, in_color->corners);
        alternative_error += marker_error_px(pose.alternative * world_from_marker, size->second,
                                             color_lens_, in_color->corners);
      }
    }
    return alternative_error < best_error ? pose.alternative : pose.camera_from_marker;
  }

  Rig rig_;
  MarkerSpec world_marker_;
  Lens color_lens_;
  std::vector<Lens> rgbd_color_lenses_;
  std::vector<Lens> depth_lenses_;
  std::map<int, double> other_marker_sizes_;
};

const bool marker_source_registered = Registry<PoseSource>::add(
    "marker",
    [](const Rig& rig, const Scene& scene) { return std::make_unique<MarkerSource>(rig, scene); });

}  // namespace
}  // namespace diminish
