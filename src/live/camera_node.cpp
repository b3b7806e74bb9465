#include "live/camera_node.h"

#include <atomic>
#include <mutex>
#include <thread>
#include <utility>

#include "camera/ros2_address.h"
#include "core/thread_name.h"
#include "diminish/error.h"
#include "live/camera_messages.h"
#include "live/read_camera.h"
#include "source/find_camera.h"

namespace diminish {
struct CameraNode::Implementation {
  explicit Implementation(const CameraNodeOptions& wanted) : options(wanted) {
    const CameraUri uri = parse_camera_uri("ros2:" + options.topic);
    uri.expect_parameters({"domain", "interface", "transport", "reliable", "keys", "mbits"});
    parse_camera_uri(options.uri);
    const auto name_of = [&](const char* name) { return ros2_topic(uri, uri.target, name); };
    name_of("rgbd");
    if (options.rig) take_lenses(*options.rig);
    const auto delivery = uri.has("reliable") ? dds::Delivery::reliable : dds::Delivery::newest;
    messages.emplace(dds::Node::open(parse_ros2_network(uri)), name_of, delivery,
                     options.jpeg_quality);
    thread = std::thread([this] { work(); });
  }
  ~Implementation() {
    is_stopped = true;
    thread.join();
  }

  void take_lenses(const Rig& rig) {
    if (options.name == "color") {
      lenses.color = rig.color;
      return;
    }
    const RgbdCamera* const camera = find_rgbd_camera(rig, options.name);
    if (!camera) throw Error("the rig has no camera '" + options.name + "'");
    lenses = {camera->color, std::nullopt, camera->depth_unit_m, camera->color_from_depth};
    if (camera->measures_depth) lenses.depth = camera->depth;
  }

  void work() {
    name_this_thread("camera");
    const CameraRequest request{options.name, options.rig ? &*options.rig : nullptr};
    const auto publish = [&](const CameraSource& source, CameraSource::Status got,
                             const CameraImage& image) {
      const bool is_good = got == CameraSource::Status::image && image.fault.empty();
      if (is_good) {
        if (!options.rig) learn_lenses(source);
        messages->send(image, lenses);
      }
      const std::lock_guard lock(mutex);
      if (got == CameraSource::Status::image) {
        ++(is_good ? status.images : status.damaged);
        if (!is_good) status.problem = image.fault;
      }
      status.moments = messages->moments();
      status.color_bytes = messages->color_bytes();
      status.depth_bytes = messages->depth_bytes();
      status.listeners = messages->listeners();
      status.compress_ms = messages->compress_ms();
      return is_good;
    };
    const bool has_ended =
        read_camera(options.uri, request, is_stopped, publish, [&](std::string& what) {
          const std::lock_guard lock(mutex);
          status.problem = std::move(what);
        });
    const std::lock_guard lock(mutex);
    status.has_ended = has_ended;
  }

  void learn_lenses(const CameraSource& source) {
    if (!lenses.color) lenses.color = source.intrinsics(Sensor::color);
    if (!lenses.depth) lenses.depth = source.intrinsics(Sensor::depth);
    lenses.color_from_depth = source.color_from_depth().value_or(RigidTransform{});
  }

  CameraNodeOptions options;
  NodeLenses lenses;
  std::optional<CameraMessages> messages;
  std::atomic<bool> is_stopped = false;
  mutable std::mutex mutex;  ///< guards the status
  CameraNodeStatus status;
  std::thread thread;  ///< last: it uses all of the above
};

CameraNode::CameraNode(const CameraNodeOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}

CameraNode::~CameraNode() = default;

CameraNodeStatus CameraNode::status() const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->status;
}

}  // namespace diminish
