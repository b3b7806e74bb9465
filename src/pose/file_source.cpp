#include <fmt/format.h>

#include <vector>

#include "diminish/pose_source.h"
#include "pose/pose_list.h"

namespace diminish {
namespace {

/// An outside tracker's poses: one list per camera.
class FileSource : public PoseSource {
 public:
  explicit FileSource(const Rig& rig) {
    rig.pose.expect_keys({"source", "files", "tolerance_s"});
    if (const Config tolerance = rig.pose.find("tolerance_s"); tolerance.exists()) {
      tolerance_s_ = tolerance.positive_number();
    }
    const Config files = rig.pose.at("files");
    color_ = load_pose_list(files.at("color").path());
    for (const RgbdCamera& camera : rig.rgbd) {
      names_.push_back(camera.name);
      depth_from_posed_.push_back(camera.depth_from_posed);
      depth_.push_back(load_pose_list(files.at(camera.name).path()));
    }
  }

  bool needs_markers() const override { return false; }

  void estimate(const FrameSet& frame, const Markers&, Poses& poses) override {
    const auto find = [&](const std::vector<StampedPose>& list, double stamp_s,
                          const std::string& camera) -> std::optional<RigidTransform> {
      if (const StampedPose* pose = find_nearest(list, stamp_s, tolerance_s_)) {
        return pose->world_from_camera.inverse();
      }
      poses.messages.push_back(
          fmt::format("no pose of {} within {:g} s of {:.6f}", camera, tolerance_s_, stamp_s));
      return std::nullopt;
    };
    poses.color_from_world = find(color_, frame.stamp_s, "color");
    for (std::size_t k = 0; k < depth_.size(); ++k) {
      if (!frame.rgbd[k].has_picture() && !frame.rgbd[k].is_remote()) continue;
      const auto posed_from_world = find(depth_[k], frame.rgbd[k].depth_stamp_s, names_[k]);
      if (posed_from_world) poses.depth_from_world[k] = depth_from_posed_[k] * *posed_from_world;
    }
  }

 private:
  double tolerance_s_ = 0.02;
  std::vector<StampedPose> color_;
  std::vector<std::string> names_;
  std::vector<RigidTransform> depth_from_posed_;
  std::vector<std::vector<StampedPose>> depth_;
};

const bool file_source_registered = Registry<PoseSource>::add(
    "file", [](const Rig& rig, const Scene&) { return std::make_unique<FileSource>(rig); });

}  // namespace
}  // namespace diminish
