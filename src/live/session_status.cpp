#include "live/session_status.h"

#include <algorithm>

#include "sink/shares.h"

namespace diminish {

bool describe_problems_of_cameras(LiveStatus& status) {
  bool has_ended = false;
  for (const CameraStatus& camera : status.cameras) {
    if (camera.state == CameraState::lost) {
      status.problems.push_back(camera.name + ": camera lost: " + camera.problem);
    } else if (camera.state == CameraState::silent) {
      status.problems.push_back(camera.name + ": the camera is silent: " + camera.problem);
    } else if (camera.state == CameraState::ended && camera.name == "color") {
      has_ended = true;
    }
  }
  return has_ended;
}

void describe_last_frame(const LiveFrame& frame, LiveStatus& status) {
  const FrameReport& report = frame.result.report;
  status.frames = frame.number;
  status.stage_ms = report.milliseconds;
  status.frame_ms = report.frame_ms;
  const auto& poses = report.poses.color_from_depth;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const bool is_spared = k < report.spared.size() && report.spared[k];
    status.posed.push_back(poses[k].has_value() || is_spared);
  }
  status.markers.push_back(report.markers.color.size());
  for (const auto& markers : report.markers.rgbd) status.markers.push_back(markers.size());
  status.occluders = report.occluders;
  const auto pixels = static_cast<double>(frame.result.mask.size());
  if (pixels > 0) status.mask_share = static_cast<double>(report.mask_pixels) / pixels;
  const Shares shares = shares_of(report.mask_pixels, report.valid_pixels, report.witnessed_pixels,
                                  report.remembered_pixels, report.estimated_pixels);
  status.seen_share = shares.seen;
  status.witnessed_share = shares.witnessed;
  status.remembered_share = shares.remembered;
  status.estimated_share = shares.estimated;
  status.invented_share = shares.invented;
  status.evidence = to_text(shares);
  status.memory = report.memory;
  for (const std::string& message : report.messages) {
    const bool is_said =
        std::any_of(status.cameras.begin(), status.cameras.end(), [&](const auto& camera) {
          return camera.state != CameraState::running && message.starts_with(camera.name + ":");
        });
    if (!is_said) status.problems.push_back(message);
  }
}

}  // namespace diminish
