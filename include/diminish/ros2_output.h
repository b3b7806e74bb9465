#pragma once

#include <memory>
#include <string>

#include "diminish/export.h"
#include "diminish/live.h"

namespace diminish {

/// Publishes a session's results as ROS 2 topics (docs/many-machines.md lists them): picture, mask
/// and provenance as images, the lens, and the session's state as diagnostics. Its own thread sends
/// the newest frame; a topic that nobody listens to costs nothing.
class DIMINISH_EXPORT Ros2Output {
 public:
  /// target: the topics' base, "/diminish", and as in a ros2: camera's URI
  /// "?domain=0&interface=...";
  /// "&reliable": what is lost on the way is sent again. Throws Error that names the target.
  Ros2Output(const LiveSession& session, const std::string& target);
  ~Ros2Output();
  Ros2Output(const Ros2Output&) = delete;
  Ros2Output& operator=(const Ros2Output&) = delete;

  /// Why it no longer sends; empty if it does.
  std::string problem() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
