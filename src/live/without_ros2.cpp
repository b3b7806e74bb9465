#include "diminish/error.h"
#include "diminish/ros2_output.h"
#include "live/camera_node.h"
#include "live/remote_camera.h"
#include "live/render_node.h"

namespace diminish {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw Error(what + ": this build is without ROS 2 (it was built without Fast DDS)");
}

}  // namespace

struct Ros2Output::Implementation {};
Ros2Output::Ros2Output(const LiveSession&, const std::string& target) {
  fail(target);
}
Ros2Output::~Ros2Output() = default;
std::string Ros2Output::problem() const {
  return "";
}

struct CameraNode::Implementation {};
CameraNode::CameraNode(const CameraNodeOptions& options) {
  fail(options.topic);
}
CameraNode::~CameraNode() = default;
CameraNodeStatus CameraNode::status() const {
  return {};
}

struct RenderNode::Implementation {};
RenderNode::RenderNode(const RenderNodeOptions& options) {
  fail(options.topic);
}
RenderNode::~RenderNode() = default;
RenderNodeStatus RenderNode::status() const {
  return {};
}

struct RemoteCamera::Implementation {};
RemoteCamera::RemoteCamera(const LiveCamera& camera, const Setting&) {
  fail(camera.uri);
}
RemoteCamera::~RemoteCamera() = default;
std::unique_ptr<RemoteCamera::Question> RemoteCamera::ask(double, double) {
  return nullptr;
}
CameraStatus RemoteCamera::status() const {
  return {};
}

}  // namespace diminish
