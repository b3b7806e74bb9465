#include <fmt/format.h>

#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "diminish/scan.h"
#include "memory/keyframe_store.h"
#include "memory/scan_frames.h"
#include "pose/camera_poses.h"

namespace diminish {
namespace {

void expect_scan(const Recording& recording) {
  const std::string file = (recording.folder / "rig.yaml").string();
  const Rig& rig = recording.rig;
  if (rig.rgbd.empty() || rig.rgbd.front().name != Scan::camera || rig.pose_source != "file") {
    throw Error(Error::input,
                fmt::format("{}: rgbd: expected a scan, whose first RGB-D camera is called '{}'; "
                            "`diminish scan` makes one of a recording",
                            file, Scan::camera));
  }
  const Intrinsics expected = scan_rig(rig).rgbd.front().depth;
  const Intrinsics& depth = rig.rgbd.front().depth;
  if (depth.width != expected.width || depth.height != expected.height) {
    throw Error(Error::input,
                fmt::format("{}: rgbd[0].depth: expected {}x{} for a colour camera of {}x{}, got "
                            "{}x{}",
                            file, expected.width, expected.height, rig.color.width,
                            rig.color.height, depth.width, depth.height));
  }
}

/// The first thing that makes a frame useless as a keyframe; empty if nothing does.
std::string fault_of(const PosedFrame& posed) {
  if (!posed.frame.faults.empty()) return posed.frame.faults.front();
  if (!posed.frame.rgbd.front().missing.empty()) return posed.frame.rgbd.front().missing;
  if (!posed.poses.color_from_world) return posed.poses.messages.front();
  return {};
}

}  // namespace

Scan load_scan(const std::filesystem::path& folder) {
  const Recording recording = load_recording(folder);
  expect_scan(recording);
  Options matching;
  matching.sync_tolerance_s = 0.001;  // all images of a frame have its timestamp
  const auto source = open_recording(recording, matching);
  if (source->frame_count() > KeyframeStore::most_keyframes) {
    throw Error(Error::input, fmt::format("{}: expected at most {} images, got {}",
                                          (folder / "color.txt").string(),
                                          KeyframeStore::most_keyframes, source->frame_count()));
  }
  CameraPoses poses(recording.rig, recording.scene);
  Scan scan{recording.rig, recording.scene, {}};
  PosedFrame posed;
  while (source->next(posed.frame)) {
    poses.estimate(posed.frame, {}, posed.poses);
    if (const std::string fault = fault_of(posed); !fault.empty()) {
      throw Error(Error::input, fmt::format("{}: {}", folder.string(), fault));
    }
    scan.frames.push_back(posed);
  }
  return scan;
}

}  // namespace diminish
