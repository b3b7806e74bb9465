#include "live/render_node.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "core/set_text.h"
#include "core/thread_name.h"
#include "diminish/camera_source.h"
#include "diminish/error.h"
#include "live/image_pairs.h"
#include "live/node_network.h"
#include "live/read_camera.h"
#include "source/find_camera.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;

/// How often questions that wait for images are looked at.
constexpr milliseconds short_wait(1);
constexpr milliseconds long_wait(5);

}  // namespace

struct RenderNode::Implementation {
  explicit Implementation(const RenderNodeOptions& wanted) : options(wanted) {
    const CameraUri uri = parse_camera_uri("node:" + options.topic);
    uri.expect_parameters({std::begin(node_network_parameters), std::end(node_network_parameters)});
    parse_camera_uri(options.uri);
    if (options.rig && !find_rgbd_camera(*options.rig, options.name)) {
      throw Error("the rig has no RGB-D camera '" + options.name + "'");
    }
    const NodeWire wire = node_wire(uri);
    const auto node = dds::Node::open(wire.network);
    questions.emplace(node);
    questions->add({ros2_topic(uri, uri.target, "question"), node_question_type}, wire.delivery);
    answers.emplace(node, dds::Topic{ros2_topic(uri, uri.target, "answer"), node_answer_type},
                    wire.delivery);
    try {
      reading = std::thread([this] { read_images(); });
      answering = std::thread([this] { answer(); });
    } catch (...) {  // the system has none to give
      stop();
      throw;
    }
  }
  ~Implementation() { stop(); }

  void stop() {
    is_stopped = true;
    if (reading.joinable()) reading.join();
    if (answering.joinable()) answering.join();
  }

  void read_images() {
    name_this_thread("camera");
    const CameraRequest request{options.name, options.rig ? &*options.rig : nullptr};
    const auto take = [&](const CameraSource&, CameraSource::Status got, CameraImage& image) {
      if (got != CameraSource::Status::image) return false;
      if (!image.fault.empty()) {
        ++damaged;
        note_failure(image.fault.c_str());
        return false;
      }
      pairs.put(image);
      ++images;
      return true;
    };
    has_ended = read_camera(options.uri, request, is_stopped, take,
                            [&](const std::string& what) { note_failure(what.c_str()); });
  }

  void answer() {
    name_this_thread("answers");
    NodeWorker worker(
        [this](double stamp_s, double tolerance_s) { return pairs.find(stamp_s, tolerance_s); },
        [this](const std::vector<std::uint8_t>& answer) { answers->send(answer); });
    dds::Received received;
    std::size_t seen = 0;
    while (!is_stopped) {
      try {
        if (questions->take(received, worker.has_waiting() ? short_wait : long_wait)) {
          worker.take(received.bytes, received.arrival_s);
        }
        if (const std::size_t now = images; now != seen) {
          seen = now;
          worker.look_again(monotonic_now_s());
          if (const auto newest = pairs.newest(moment_s)) {
            worker.prepare(newest, monotonic_now_s());
          }
        }
        worker.look_again(monotonic_now_s());
        const std::lock_guard lock(mutex);
        static_cast<NodeCounts&>(status) = worker.counts();
        status.users = worker.users(monotonic_now_s());
      } catch (const std::exception& error) {
        note_failure(error.what());
      } catch (...) {
        note_failure("an unknown error");
      }
    }
  }

  void note_failure(const char* what) {
    const std::lock_guard lock(mutex);
    set_text(status.camera_problem, what);
  }

  RenderNodeOptions options;
  std::optional<dds::Subscriptions> questions;
  std::optional<dds::Publication> answers;
  ImagePairs pairs;
  std::atomic<bool> is_stopped = false, has_ended = false;
  std::atomic<std::size_t> images = 0, damaged = 0;
  mutable std::mutex mutex;  ///< guards the status
  RenderNodeStatus status;
  std::thread reading, answering;  ///< last: they use all of the above
};

RenderNode::RenderNode(const RenderNodeOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}

RenderNode::~RenderNode() = default;

RenderNodeStatus RenderNode::status() const {
  const Implementation& self = *implementation_;
  const std::lock_guard lock(self.mutex);
  RenderNodeStatus status = self.status;
  status.has_ended = self.has_ended;
  status.images = self.images;
  status.damaged = self.damaged;
  return status;
}

}  // namespace diminish
