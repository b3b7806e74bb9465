#include "ros/frame_tree.h"

namespace diminish::ros {
namespace {

constexpr std::size_t most_children = 1000;

}  // namespace

std::string plain_frame(const std::string& frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

void FrameTree::add(const TfMessage& message) {
  for (const TransformStamped& transform : message.transforms) {
    const std::string child = plain_frame(transform.child);
    if (parents_.size() >= most_children && !parents_.contains(child)) continue;
    parents_[child] = {plain_frame(transform.header.frame_id), transform.parent_from_child};
  }
}

std::optional<RigidTransform> FrameTree::find(const std::string& to,
                                              const std::string& from) const {
  // All frames above `from`, each with its transform; then up from `to` until one of them.
  std::map<std::string, RigidTransform> above_from_from;
  std::string frame = plain_frame(from);
  RigidTransform frame_from_from;
  while (
      above_from_from.emplace(frame, frame_from_from).second) {  // else they go round in a circle
    const auto edge = parents_.find(frame);
    if (edge == parents_.end()) break;
    frame_from_from = edge->second.parent_from_child * frame_from_from;
    frame = edge->second.parent;
  }
  frame = plain_frame(to);
  RigidTransform frame_from_to;
  for (std::size_t steps = 0; steps <= parents_.size(); ++steps) {
    const auto common = above_from_from.find(frame);
    if (common != above_from_from.end()) return frame_from_to.inverse() * common->second;
    const auto edge = parents_.find(frame);
    if (edge == parents_.end()) break;
    frame_from_to = edge->second.parent_from_child * frame_from_to;
    frame = edge->second.parent;
  }
  return std::nullopt;
}

}  // namespace diminish::ros
