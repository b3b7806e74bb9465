#pragma once

#include <memory>
#include <string>

#include "diminish/export.h"
#include "diminish/live.h"

namespace diminish {

/// Sends a session's results to a video device through GStreamer, so that any program that reads a
/// camera can use them. Its own thread writes the newest frame.
class DIMINISH_EXPORT VirtualCamera {
 public:
  /// target: "/dev/videoN" of v4l2loopback, or "gst:" and the end of a pipeline.
  /// Throws Error that names the target if it cannot be opened.
  VirtualCamera(const LiveSession& session, const std::string& target, double frames_per_second);
  ~VirtualCamera();
  VirtualCamera(const VirtualCamera&) = delete;
  VirtualCamera& operator=(const VirtualCamera&) = delete;

  /// Why it no longer writes; empty if it does.
  std::string problem() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
