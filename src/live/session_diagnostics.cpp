#include "live/session_diagnostics.h"

#include <fmt/format.h>

namespace diminish {
namespace {

using ros::DiagnosticStatus;

DiagnosticStatus::Level level_of(CameraState state) {
  switch (state) {
    case CameraState::running:
      return DiagnosticStatus::ok;
    case CameraState::opening:
    case CameraState::ended:
      return DiagnosticStatus::stale;
    case CameraState::silent:
      return DiagnosticStatus::warn;
    case CameraState::lost:
      break;
  }
  return DiagnosticStatus::error;
}

std::string figure(double value) {
  return fmt::format("{:.3g}", value);
}

DiagnosticStatus result_status(const LiveStatus& status) {
  DiagnosticStatus result;
  result.name = "diminish: result";
  result.hardware_id = "diminish";
  result.level = !status.running           ? DiagnosticStatus::stale
                 : status.problems.empty() ? DiagnosticStatus::ok
                                           : DiagnosticStatus::warn;
  for (const std::string& problem : status.problems) {
    result.message += (result.message.empty() ? "" : "; ") + problem;
  }
  if (result.message.empty()) result.message = status.running ? "running" : "not running";
  result.values = {{"frames", fmt::format("{}", status.frames)},
                   {"frames/s", figure(status.frames_per_second)},
                   {"skipped", fmt::format("{}", status.skipped)},
                   {"failed", fmt::format("{}", status.failed)},
                   {"latency ms, median", figure(status.latency_ms.p50)},
                   {"latency ms, 95 %", figure(status.latency_ms.p95)},
                   {"quality level", fmt::format("{}", status.quality_level)},
                   {"seen share", figure(status.seen_share)},
                   {"remembered share", figure(status.remembered_share)},
                   {"seen without depth, share", figure(status.estimated_share)},
                   {"invented share", figure(status.invented_share)}};
  return result;
}

DiagnosticStatus camera_status(const CameraStatus& camera) {
  DiagnosticStatus result;
  result.name = "diminish: camera " + camera.name;
  result.hardware_id = camera.uri;
  result.level = level_of(camera.state);
  result.message = camera_state_names[static_cast<std::size_t>(camera.state)];
  if (camera.state != CameraState::running && !camera.problem.empty()) {
    result.message += ": " + camera.problem;
  }
  result.values = {{"images/s", figure(camera.images_per_second)},
                   {"images", fmt::format("{}", camera.images)},
                   {"dropped", fmt::format("{}", camera.dropped)},
                   {"damaged", fmt::format("{}", camera.damaged)},
                   {"out of order", fmt::format("{}", camera.out_of_order)},
                   {"reconnects", fmt::format("{}", camera.reconnects)}};
  if (camera.clock) {
    result.values.push_back({"clock offset ms", figure(camera.clock->offset_s * 1e3)});
    result.values.push_back({"clock drift ppm", figure(camera.clock->drift * 1e6)});
  }
  return result;
}

}  // namespace

ros::DiagnosticArray diagnostics_of(const LiveStatus& status) {
  ros::DiagnosticArray array;
  array.statuses.push_back(result_status(status));
  for (const CameraStatus& camera : status.cameras) array.statuses.push_back(camera_status(camera));
  return array;
}

}  // namespace diminish
