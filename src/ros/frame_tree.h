#pragma once

#include <map>
#include <optional>
#include <string>

#include "diminish/rigid_transform.h"
#include "ros/messages.h"

namespace diminish::ros {

/// ROS 1's tf wrote "/camera_link" for "camera_link".
std::string plain_frame(const std::string& frame);

/// The frames of /tf and /tf_static: the newest transform from each frame to its parent.
class FrameTree {
 public:
  /// Frames beyond the first thousand are left out.
  void add(const TfMessage& message);
  /// Nothing where the two are not connected.
  std::optional<RigidTransform> find(const std::string& to, const std::string& from) const;
  bool empty() const { return parents_.empty(); }

 private:
  struct Edge {
    std::string parent;
    RigidTransform parent_from_child;
  };
  std::map<std::string, Edge> parents_;
};

}  // namespace diminish::ros
