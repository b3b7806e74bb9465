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
#include "source/find_camera.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;

/// As for a session's cameras.
constexpr double first_retry_s = 0.2;
constexpr double last_retry_s = 5;
/// Two sensors' images so far apart are of one moment.
constexpr double moment_s = 0.02;
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
      reading = std::thread([this] { read_camera(); });
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

  void read_camera() {
    name_this_thread("camera");
    double retry_s = first_retry_s;
    while (!is_stopped) {
      const std::size_t before = images;
      std::string what;
      bool is_done = false;
      try {
        read_until_gone();
        is_done = true;
      } catch (const std::exception& error) {
        set_text(what, error.what());
      } catch (...) {
        set_text(what, "an unknown error");
      }
      if (is_done) {
        has_ended = !is_stopped;
        return;
      }
      note_failure(what.c_str());
      retry_s = images > before ? first_retry_s : std::min(2 * retry_s, last_retry_s);
      const double end_s = monotonic_now_s() + retry_s;
      while (!is_stopped && monotonic_now_s() < end_s)
        std::this_thread::sleep_for(milliseconds(20));
    }
  }

  void read_until_gone() {
    CameraRequest request;
    request.name = options.name;
    request.rig = options.rig ? &*options.rig : nullptr;
    request.epoch_s = monotonic_now_s();
    const auto source = open_camera(options.uri, request);
    CameraImage image;
    while (!is_stopped) {
      const auto got = source->read(image, milliseconds(100));
      if (got == CameraSource::Status::end) return;
      if (got != CameraSource::Status::image) continue;
      if (image.fault.empty()) {
        pairs.put(image);
        ++images;
      } else {
        ++damaged;
        note_failure(image.fault.c_str());
      }
    }
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
