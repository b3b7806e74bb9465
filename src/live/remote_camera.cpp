#include "live/remote_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <mutex>
#include <random>
#include <thread>

#include "core/set_text.h"
#include "core/thread_name.h"
#include "core/tracing.h"
#include "diminish/error.h"
#include "live/node_clock.h"
#include "live/node_network.h"
#include "live/sliding_window.h"
#include "pose/pose_refinement.h"
#include "remote/asked_images.h"
#include "scene/sample_grid.h"
#include "sink/distribution.h"

namespace diminish {
namespace {

/// Of this many remote cameras each is asked for all of its samples; more share them.
constexpr std::size_t cameras_with_all_samples = 2;
/// A node that said nothing for this long is not waited for, until it speaks.
constexpr double patience_s = 0.5;
constexpr double unanswered_after_s = 1;
constexpr std::size_t most_asked = 8;

RemoteSettings parse_settings(const CameraUri& uri, bool is_within_machine) {
  std::vector<std::string> known = {"lossless", "quality", "depth_step", "wait"};
  known.insert(known.end(), std::begin(node_network_parameters), std::end(node_network_parameters));
  uri.expect_parameters(known);
  RemoteSettings settings;
  LayerCoding& coding = settings.coding;
  if (uri.has("lossless")) {
    if (uri.has("quality") || uri.has("depth_step")) {
      uri.fail("expected lossless, or quality and depth_step");
    }
    coding.jpeg_quality = 0;
    coding.depth_unit_m = 0;
  } else {
    coding.raw = is_within_machine && !uri.has("quality") && !uri.has("depth_step");
    coding.jpeg_quality = static_cast<int>(uri.number("quality", coding.jpeg_quality, 1, 100));
    coding.depth_unit_m = 1e-3 * uri.number("depth_step", 1e3 * coding.depth_unit_m, 0.01, 100);
  }
  settings.wait_s = 1e-3 * uri.number("wait", 1e3 * settings.wait_s, 1, 60'000);
  return settings;
}

GlanceQuestion question_of(const RemoteCamera::Setting& setting) {
  GlanceQuestion question;
  question.camera = setting.camera;
  question.user = setting.user;
  question.wishes.marker_dictionary = setting.marker_dictionary;
  question.wishes.spacings_px = PoseRefinement::usual_spacings_px(setting.user);
  const std::size_t sharing = std::max(setting.remote_cameras, cameras_with_all_samples);
  question.wishes.samples =
      static_cast<int>(SampleGrid::usual_samples * cameras_with_all_samples / sharing);
  return question;
}

/// Adds the time that this thread works.
class OwnTime {
 public:
  explicit OwnTime(std::atomic<std::int64_t>& sum_ns)
      : sum_ns_(sum_ns), begin_ns_(tracing::thread_now_ns()) {}
  ~OwnTime() { sum_ns_ += tracing::thread_now_ns() - begin_ns_; }
  OwnTime(const OwnTime&) = delete;
  OwnTime& operator=(const OwnTime&) = delete;

 private:
  std::atomic<std::int64_t>& sum_ns_;
  std::int64_t begin_ns_;
};

std::uint64_t random_number() {
  std::random_device device;
  return std::uint64_t{device()} << 32 | device();
}

}  // namespace

struct RemoteCamera::Implementation {
  Implementation(const LiveCamera& camera_, const Setting& setting)
      : camera(camera_), question(question_of(setting)) {
    const CameraUri uri = parse_camera_uri(camera.uri);
    const NodeWire wire = node_wire(uri);
    settings = parse_settings(uri, wire.network.is_within_machine());
    question.wishes.exact = settings.coding.is_exact();
    if (!setting.camera.measures_depth) {
      uri.fail("expected a camera that measures depth, " + camera.name + " does not");
    }
    const auto node = dds::Node::open(wire.network);
    answers.emplace(node);
    answers->add({ros2_topic(uri, uri.target, "answer"), node_answer_type}, wire.delivery);
    questions = std::make_shared<dds::Publication>(
        node, dds::Topic{ros2_topic(uri, uri.target, "question"), node_question_type},
        wire.delivery);
    status.name = camera.name;
    status.uri = camera.uri;
    receiving = std::thread([this] { receive(); });
  }
  ~Implementation() {
    is_stopped = true;
    receiving.join();
  }

  std::shared_ptr<AskedImages> ask(double stamp_s, double tolerance_s) {
    const OwnTime time(own_ns);
    GlanceQuestion asked = question;
    std::shared_ptr<AskedImages> images;
    {
      const std::lock_guard lock(mutex);
      asked.asked_s = monotonic_now_s();
      // Until the node's clock is known, it is asked for nothing but that.
      if (const auto offset_s = clock.offset_s()) {
        asked.stamp_s = stamp_s + *offset_s;
        asked.tolerance_s = tolerance_s;
        asked.patience_s = settings.wait_s;
      }
      images = std::make_shared<AskedImages>(
          camera.name, NodeHead{NodeTopic::glance, user, ++frames}, asked, settings,
          [this, to = questions](const std::vector<std::uint8_t>& bytes) {
            sent_bytes += bytes.size();
            ++sent;
            to->send(bytes);
          });
      open.push_back(images);
      if (open.size() > most_asked) open.pop_front();
    }
    images->ask();
    return images;
  }

  void receive() {
    name_this_thread("node answers");
    dds::Received received;
    while (!is_stopped) {
      try {
        const OwnTime time(own_ns);
        if (answers->take(received, std::chrono::milliseconds(100))) take(received);
      } catch (const std::exception& error) {
        note_damage(error.what());
      } catch (...) {
        note_damage("an unknown error");
      }
    }
  }

  void note_damage(const char* what) {
    const std::lock_guard lock(mutex);
    ++status.damaged;
    set_text(status.problem, what);
  }

  void take(const dds::Received& received) {
    auto answer = open_answer(received.bytes);
    if (answer.head.user != user) return;
    std::shared_ptr<AskedImages> images;
    double offset_s = 0;
    {
      const std::lock_guard lock(mutex);
      const bool was_silent = received.arrival_s > last_answer_s + unanswered_after_s;
      if (was_silent && last_answer_s > 0) ++status.reconnects;
      last_answer_s = received.arrival_s;
      if (answer.head.topic == NodeTopic::glance) {
        clock.add(answer.head.asked_s, answer.head.received_s, answer.head.sent_s,
                  received.arrival_s);
        if (answer.head.problem.empty()) {
          ++status.images;
          arrivals_s.add(received.arrival_s);
        }
      }
      offset_s = clock.offset_s().value_or(0);
      const auto found = std::find_if(open.begin(), open.end(), [&](const auto& one) {
        return one->frame() == answer.head.frame;
      });
      if (found == open.end()) return;
      images = *found;
    }
    const bool is_in_time = images->take(answer, offset_s);
    const std::lock_guard lock(mutex);
    remote.bytes_received += received.bytes.size();
    if (!is_in_time || !answer.head.problem.empty()) return;
    if (answer.head.topic == NodeTopic::glance) {
      ++remote.glances;
      return;
    }
    own_ns += images->question_ns();
    ++remote.layers;
    const double whole_s = received.arrival_s - images->asked_for_layer_s();
    layers_ms.add(1e3 * whole_s);
    ways_ms.add(1e3 * (whole_s - (answer.head.sent_s - answer.head.received_s)));
  }

  bool is_speaking() const {
    const std::lock_guard lock(mutex);
    return monotonic_now_s() < last_answer_s + patience_s;
  }

  CameraStatus state() const {
    const std::lock_guard lock(mutex);
    CameraStatus now = status;
    now.images_per_second = arrivals_s.rate();
    const double age_s = monotonic_now_s() - last_answer_s;
    now.state = last_answer_s == 0           ? CameraState::opening
                : age_s < unanswered_after_s ? CameraState::running
                                             : CameraState::silent;
    if (now.state == CameraState::silent) {
      now.problem = fmt::format("no answer for {} s", unanswered_after_s);
    }
    now.dropped = answers->lost();
    now.remote = remote;
    now.remote->frames = frames;
    now.remote->asked_layers = sent - frames;
    now.remote->bytes_sent = sent_bytes;
    now.remote->own_ms = 1e-6 * static_cast<double>(own_ns) /
                         static_cast<double>(std::max<std::uint64_t>(frames, 1));
    now.remote->layer_ms = distribution_of(layers_ms.values()).p50;
    now.remote->way_ms = distribution_of(ways_ms.values()).p50;
    return now;
  }

  LiveCamera camera;
  GlanceQuestion question;
  RemoteSettings settings;
  const std::uint64_t user = random_number();
  std::optional<dds::Subscriptions> answers;
  std::shared_ptr<dds::Publication> questions;
  std::atomic<bool> is_stopped = false;
  std::atomic<std::size_t> sent = 0, sent_bytes = 0;
  std::atomic<std::int64_t> own_ns = 0;
  mutable std::mutex mutex;  ///< guards the members up to the next blank line
  std::deque<std::shared_ptr<AskedImages>> open;
  std::uint64_t frames = 0;
  NodeClock clock;
  double last_answer_s = 0;
  SlidingWindow arrivals_s{60}, layers_ms{150}, ways_ms{150};
  CameraStatus status;
  RemoteStatus remote;

  std::thread receiving;  ///< last: it uses all of the above
};

namespace {

class AskedQuestion : public RemoteCamera::Question {
 public:
  AskedQuestion(std::shared_ptr<AskedImages> images, double until_s)
      : images_(std::move(images)), until_s_(until_s) {}

  void wait(RgbdFrame& rgbd) override {
    rgbd.color.own().resize(0, 0);
    rgbd.depth.own().resize(0, 0);
    rgbd.remote.reset();
    if (!images_->wait_for_glance(until_s_)) {
      rgbd.missing = images_->problem();
      return;
    }
    const Glance& glance = images_->glance();
    rgbd.missing.clear();
    rgbd.color_stamp_s = glance.color_stamp_s;
    rgbd.depth_stamp_s = glance.depth_stamp_s;
    rgbd.depth = ImageView<std::uint16_t>(glance.depth);
    rgbd.remote = images_;
  }

 private:
  std::shared_ptr<AskedImages> images_;
  double until_s_;
};

}  // namespace

RemoteCamera::RemoteCamera(const LiveCamera& camera, const Setting& setting)
    : implementation_(std::make_unique<Implementation>(camera, setting)) {}

RemoteCamera::~RemoteCamera() = default;

std::unique_ptr<RemoteCamera::Question> RemoteCamera::ask(double stamp_s, double tolerance_s) {
  Implementation& self = *implementation_;
  const double wait_s = self.is_speaking() ? self.settings.wait_s : 0;
  return std::make_unique<AskedQuestion>(self.ask(stamp_s, tolerance_s),
                                         monotonic_now_s() + wait_s);
}

CameraStatus RemoteCamera::status() const {
  return implementation_->state();
}

}  // namespace diminish
