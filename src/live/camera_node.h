#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "diminish/rig.h"

namespace diminish {

struct CameraNodeOptions {
  std::string uri;         ///< the local camera
  std::string name;        ///< "color", or an RGB-D camera's name in the rig
  std::string topic;       ///< the topics' base, and "?domain=0&interface=..."
  std::optional<Rig> rig;  ///< has the lenses; without it the driver's are published
  int jpeg_quality = 92;
};

/// What a node has done.
struct CameraNodeStatus {
  bool has_ended = false;  ///< the camera has no more images
  std::string problem;     ///< the last one
  std::size_t images = 0, damaged = 0, moments = 0;
  std::size_t color_bytes = 0, depth_bytes = 0;  ///< of the combined messages
  std::size_t listeners = 0;                     ///< of all topics
  double compress_ms = 0;                        ///< all of the compressing
};

/// Publishes a local camera as ROS 2 topics (docs/many-machines.md lists them): images as they are,
/// compressed, and both sensors' images of a moment in one message. Its own thread reads the camera
/// and opens it again when it is lost. A topic that nobody listens to costs nothing.
class CameraNode {
 public:
  /// Throws Error that names the topic or the rig's camera. A camera that cannot be opened is no
  /// error: it is tried again.
  explicit CameraNode(const CameraNodeOptions& options);
  ~CameraNode();
  CameraNode(const CameraNode&) = delete;
  CameraNode& operator=(const CameraNode&) = delete;

  CameraNodeStatus status() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
