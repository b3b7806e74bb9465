#pragma once

#include <filesystem>
#include <string>

#include "diminish/frame_source.h"
#include "diminish/occluder_detector.h"

namespace diminish {

/// The input of a detector, to be filled by a test, and its output.
struct Detection {
  explicit Detection(const Rig& a_rig) : rig(a_rig) {
    const std::size_t count = rig.rgbd.size();
    frame.color.own().resize(rig.color.width, rig.color.height, Bgr{});
    markers.rgbd.resize(count);
    poses.depth_from_world.resize(count);
    poses.color_from_depth.resize(count);
    masks.color.resize(rig.color.width, rig.color.height, 0);
    for (const RgbdCamera& camera : rig.rgbd) {
      RgbdFrame& rgbd = frame.rgbd.emplace_back();
      rgbd.color.own().resize(camera.color.width, camera.color.height, Bgr{});
      rgbd.depth.own().resize(camera.depth.width, camera.depth.height, 0);
      masks.rgbd_color.emplace_back(camera.color.width, camera.color.height);
      masks.rgbd_depth.emplace_back(camera.depth.width, camera.depth.height);
    }
  }

  Observation observation() const { return {frame, markers, poses, options}; }

  /// Clears the masks and fills them.
  OccluderReport detect(OccluderDetector& detector) {
    masks.color.fill(0);
    for (Mask& mask : masks.rgbd_color) mask.fill(0);
    for (Mask& mask : masks.rgbd_depth) mask.fill(0);
    return detector.detect(observation(), masks);
  }

  Rig rig;
  FrameSet frame;
  Markers markers;
  Poses poses;
  Options options;
  OcclusionMasks masks;
};

/// A detector from its part of a scene.yaml.
inline std::unique_ptr<OccluderDetector> make_detector(
    const std::string& yaml, const Rig& rig, const std::filesystem::path& file = "s.yaml") {
  const Config config = Config::parse(yaml, file);
  const std::string detector = config.at("detector").text();
  const OccluderDetector::Entry& entry = Registry<OccluderDetector>::get(detector);
  const OccluderSpec spec{config.at("name").text(), detector, entry.read(config), config};
  spec.settings->check(config, &rig);
  return entry.make(spec, rig);
}

inline bool any_set(const Mask& mask) {
  return !bounding_box(mask).empty();
}

}  // namespace diminish
