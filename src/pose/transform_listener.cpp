#include "pose/transform_listener.h"

#include <chrono>
#include <map>
#include <utility>

#include "diminish/error.h"

namespace diminish {
namespace {

using dds::Delivery;
using Kind = ros::TransformBuffer::Found::Kind;

}  // namespace

std::shared_ptr<TransformListener> TransformListener::open(const dds::Network& network,
                                                           Ros2Address::Clock clock) {
  using Key = std::pair<const dds::Node*, Ros2Address::Clock>;
  static std::mutex mutex;
  static std::map<Key, std::weak_ptr<TransformListener>> listeners;
  const std::shared_ptr<dds::Node> node = dds::Node::open(network);
  const std::lock_guard lock(mutex);
  std::weak_ptr<TransformListener>& known = listeners[{node.get(), clock}];
  if (auto listener = known.lock()) return listener;
  const std::shared_ptr<TransformListener> made(new TransformListener(node, clock));
  known = made;
  return made;
}

TransformListener::TransformListener(std::shared_ptr<dds::Node> node, Ros2Address::Clock clock)
    : clock_(clock), subscriptions_(std::move(node)) {
  subscriptions_.add({"/tf", ros::TfMessage::dds_type}, Delivery::reliable);
  static_topic_ = subscriptions_.add({"/tf_static", ros::TfMessage::dds_type}, Delivery::kept);
  thread_ = std::thread([this] { work(); });
}

TransformListener::~TransformListener() {
  is_stopped_ = true;
  thread_.join();
}

void TransformListener::work() {
  dds::Received received;
  while (!is_stopped_) {
    std::string problem;
    try {
      if (!subscriptions_.take(received, std::chrono::milliseconds(100))) continue;
      take(received);
    } catch (const std::exception& error) {
      problem = error.what();
    }
    if (!problem.empty()) {
      const std::lock_guard lock(mutex_);
      problem_ = (received.topic == static_topic_ ? "/tf_static: " : "/tf: ") + problem;
    }
    changed_.notify_all();
  }
}

void TransformListener::take(const dds::Received& received) {
  const auto message = ros::read_message<ros::TfMessage>(received.bytes);
  if (message.transforms.empty()) return;
  const std::lock_guard lock(mutex_);
  if (received.topic == static_topic_) {
    buffer_.add_static(message);
    return;
  }
  clock_.local_s(message.transforms.front().header.stamp_s, received.arrival_s,
                 utc_from_monotonic_s());
  buffer_.add(message, clock_.offset_s());
}

ros::TransformBuffer::Found TransformListener::find(const std::string& to, const std::string& from,
                                                    double time_s, double most_gap_s,
                                                    double wait_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(wait_s);
  std::unique_lock lock(mutex_);
  while (true) {
    auto found = buffer_.find(to, from, time_s, most_gap_s);
    if (found.kind != Kind::not_yet || time_s - found.newest_s > most_gap_s) return found;
    if (changed_.wait_until(lock, end) == std::cv_status::timeout) {
      return buffer_.find(to, from, time_s, most_gap_s);
    }
  }
}

std::string TransformListener::take_problem() {
  const std::lock_guard lock(mutex_);
  return std::exchange(problem_, "");
}

}  // namespace diminish
