#pragma once

#include <memory>
#include <optional>
#include <string>

#include "diminish/rig.h"
#include "remote/node_worker.h"

namespace diminish {

struct RenderNodeOptions {
  std::string uri;         ///< the local RGB-D camera
  std::string name;        ///< its name in the rig
  std::string topic;       ///< the topics' base, and "?domain=0&interface=..."
  std::optional<Rig> rig;  ///< for the camera's driver; the drawing uses the user's
};

struct RenderNodeStatus : NodeCounts {
  bool has_ended = false;      ///< the camera has no more images
  std::string camera_problem;  ///< the last one
  std::size_t images = 0, damaged = 0;
  std::size_t users = 0;  ///< who asked within the last second
};

/// Draws what a local RGB-D camera sees from the viewpoints of users on other machines, and sends
/// them that alone (docs/render-node.md). One thread reads the camera and opens it again when it is
/// lost, another answers.
class RenderNode {
 public:
  /// Throws Error that names the topic or the rig's camera. A camera that cannot be opened is no
  /// error: it is tried again.
  explicit RenderNode(const RenderNodeOptions& options);
  ~RenderNode();
  RenderNode(const RenderNode&) = delete;
  RenderNode& operator=(const RenderNode&) = delete;

  RenderNodeStatus status() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
