#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "diminish/live.h"

namespace diminish {

/// Sends a session's results to a video device through GStreamer, so that any program that reads a
/// camera can use them. Its own thread writes the newest frame.
class VirtualCamera {
 public:
  /// target: "/dev/videoN" of v4l2loopback, or "gst:" and the end of a pipeline.
  /// Throws Error that names the target if it cannot be opened.
  VirtualCamera(const LiveSession& session, const std::string& target, double frames_per_second);
  ~VirtualCamera();
  VirtualCamera(const VirtualCamera&) = delete;
  VirtualCamera& operator=(const VirtualCamera&) = delete;

 private:
  struct Writer;
  std::unique_ptr<Writer> writer_;
  std::atomic<bool> stopped_ = false;
  std::thread thread_;
};

}  // namespace diminish
