#include <algorithm>
#include <vector>

#include "diminish/pose_source.h"
#include "pose/known_markers.h"
#include "pose/marker_pose.h"
#include "source/find_camera.h"
#include "source/read_rigid_transform.h"

namespace diminish {
namespace {

/// Rigidly mounted cameras: one transform for each RGB-D camera, from the configuration. Where the
/// world is asked for (a box in its frame), it is the world marker's, if the colour camera sees it.
class FixedSource : public PoseSource {
 public:
  FixedSource(const Rig& rig, const Scene& scene)
      : color_lens_(rig.color), world_marker_(scene.world_marker) {
    rig.pose.expect_keys({"source", "color_from_rgbd"});
    const Config transforms = rig.pose.at("color_from_rgbd");
    for (const std::string& name : transforms.keys()) {
      if (!find_rgbd_camera(rig, name)) {
        transforms.at(name).fail("the rig has no RGB-D camera of this name");
      }
    }
    for (const RgbdCamera& camera : rig.rgbd) {
      color_from_depth_.push_back(read_rigid_transform(transforms.at(camera.name)) *
                                  camera.depth_from_posed.inverse());
    }
    world_needed_ = world_marker_.size_m > 0 &&
                    std::any_of(scene.occluders.begin(), scene.occluders.end(),
                                [](const OccluderSpec& occluder) {
                                  return occluder.settings && occluder.settings->needs_world();
                                });
  }

  bool needs_markers() const override { return world_needed_; }

  void estimate(const FrameSet&, const Markers& markers, Poses& poses) override {
    poses.color_from_depth.assign(color_from_depth_.begin(), color_from_depth_.end());
    if (!world_needed_) return;
    if (const Marker* marker = find_marker(markers.color, world_marker_.id)) {
      if (const auto pose =
              estimate_marker_pose(marker->corners, world_marker_.size_m, color_lens_)) {
        poses.color_from_world = pose->camera_from_marker;
      }
    }
    if (!poses.color_from_world) {
      poses.messages.push_back("world marker " + std::to_string(world_marker_.id) +
                               " not visible in color");
    }
  }

 private:
  Lens color_lens_;
  MarkerSpec world_marker_;
  std::vector<RigidTransform> color_from_depth_;
  bool world_needed_ = false;
};

const bool fixed_source_registered = Registry<PoseSource>::add(
    "fixed",
    [](const Rig& rig, const Scene& scene) { return std::make_unique<FixedSource>(rig, scene); });

}  // namespace
}  // namespace diminish
