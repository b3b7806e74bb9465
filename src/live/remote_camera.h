#pragma once

#include <memory>
#include <string>

#include "diminish/frame_set.h"
#include "diminish/live.h"

namespace diminish {

/// Whether a camera's URI names a node that draws: "node:/rgbd0".
inline bool is_node_uri(const std::string& uri) {
  return uri.starts_with("node:");
}

/// An RGB-D camera whose images stay on another machine (RenderNode), as a session uses it: for
/// each frame it is asked, and it answers in time or takes no part. Its own thread receives.
class RemoteCamera {
 public:
  struct Setting {
    RgbdCamera camera;               ///< as in the rig
    Intrinsics user;                 ///< the user's colour camera
    std::string marker_dictionary;   ///< empty: none are needed
    std::size_t remote_cameras = 1;  ///< how many the session has: they share the samples
  };
  /// Throws Error that names the URI and what was expected.
  RemoteCamera(const LiveCamera& camera, const Setting& setting);
  ~RemoteCamera();
  RemoteCamera(const RemoteCamera&) = delete;
  RemoteCamera& operator=(const RemoteCamera&) = delete;

  /// A frame's question on its way.
  class Question {
   public:
    virtual ~Question() = default;
    /// Waits for the answer, and fills the camera's part of the frame: what is missing, it says.
    virtual void wait(RgbdFrame& rgbd) = 0;
  };
  /// Asks for what it saw at a time on the monotonic clock. Does not wait.
  std::unique_ptr<Question> ask(double stamp_s, double tolerance_s);

  CameraStatus status() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
