#include <fmt/format.h>

#include <vector>

#include "core/text.h"
#include "diminish/error.h"
#include "diminish/pose_source.h"
#include "pose/transform_listener.h"

namespace diminish {
namespace {

using Kind = ros::TransformBuffer::Found::Kind;

/// A robot's poses, live: from ROS 2's transforms, at each image's own time.
class TfSource : public PoseSource {
 public:
  explicit TfSource(const Rig& rig) {
    rig.pose.expect_keys({"source", "world", "frames", "from", "wait_s", "gap_s"});
    const auto seconds = [&](const char* key, double& value) {
      const Config config = rig.pose.find(key);
      if (config.exists()) value = config.positive_number();
    };
    seconds("wait_s", wait_s_);
    seconds("gap_s", gap_s_);
    world_ = rig.pose.at("world").text();
    const Config frames = rig.pose.at("frames");
    color_ = frames.at("color").text();
    std::vector<std::string> known = {"color"};
    for (const RgbdCamera& camera : rig.rgbd) {
      known.push_back(camera.name);
      cameras_.push_back({camera.name, frames.at(camera.name).text(), camera.depth_from_posed});
    }
    frames.expect_keys(known);
    listen(rig.pose.find("from"));
  }

  bool needs_markers() const override { return false; }

  void estimate(const FrameSet& frame, const Markers&, Poses& poses) override {
    const std::string problem = listener_->take_problem();
    if (!problem.empty()) poses.messages.push_back(problem);
    poses.color_from_world = find(color_, frame.stamp_s, "color", poses);
    for (std::size_t k = 0; k < cameras_.size(); ++k) {
      if (!frame.rgbd[k].has_picture() && !frame.rgbd[k].is_remote()) continue;
      const auto posed_from_world =
          find(cameras_[k].frame, frame.rgbd[k].depth_stamp_s, cameras_[k].name, poses);
      if (posed_from_world) {
        poses.depth_from_world[k] = cameras_[k].depth_from_posed * *posed_from_world;
      }
    }
  }

 private:
  struct Camera {
    std::string name, frame;
    RigidTransform depth_from_posed;
  };

  void listen(const Config& from) {
    try {
      const CameraUri uri = parse_camera_uri(from.exists() ? from.text() : "ros2:");
      if (uri.scheme != "ros2" || !uri.target.empty()) {
        uri.fail("expected ros2:, with parameters such as ?interface=ADDRESS");
      }
      uri.expect_parameters({"clock", "domain", "interface", "transport", "keys"});
      listener_ = TransformListener::open(parse_ros2_network(uri), parse_ros2_clock(uri));
    } catch (const Error& error) {
      if (from.exists()) from.fail(error.what());
      throw;
    }
  }

  std::optional<RigidTransform> find(const std::string& camera_frame, double stamp_s,
                                     const std::string& name, Poses& poses) {
    const auto found = listener_->find(camera_frame, world_, stamp_s, gap_s_, wait_s_);
    switch (found.kind) {
      case Kind::known:
        return found.to_from_from;
      case Kind::not_yet:
        poses.messages.push_back(fmt::format(
            "no pose of {}: the newest transform of {} is {:.2g} s older than the image", name,
            printable(found.frame), stamp_s - found.newest_s));
        break;
      case Kind::lost:
        poses.messages.push_back(
            fmt::format("no pose of {}: no transforms of {} within {:g} s around the image", name,
                        printable(found.frame), gap_s_));
        break;
      case Kind::unknown:
        poses.messages.push_back(fmt::format("no pose of {}: /tf does not connect {} and {}", name,
                                             printable(camera_frame), printable(world_)));
        break;
    }
    return std::nullopt;
  }

  double wait_s_ = 0.1, gap_s_ = 0.5;
  std::string world_, color_;
  std::vector<Camera> cameras_;
  std::shared_ptr<TransformListener> listener_;
};

const bool tf_source_registered = Registry<PoseSource>::add(
    "tf", [](const Rig& rig, const Scene&) { return std::make_unique<TfSource>(rig); });

}  // namespace
}  // namespace diminish
