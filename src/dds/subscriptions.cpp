#include <atomic>
#include <condition_variable>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <mutex>

#include "dds/node.h"

namespace diminish::dds {
namespace {

using namespace eprosima::fastdds::dds;

/// Messages that wait to be taken: of images the newest few, of what is sent once all.
constexpr int newest_received = 4;
constexpr int reliable_received = 8;
constexpr int kept_received = 100;

/// What the readers tell the one thread that takes. Called by DDS's threads; it throws nothing.
class Arrivals : public DataReaderListener {
 public:
  void on_data_available(DataReader*) override {
    {
      const std::lock_guard lock(mutex_);
      has_arrived_ = true;
    }
    changed_.notify_all();
  }
  void on_sample_lost(DataReader*, const SampleLostStatus& status) override {
    lost_ += static_cast<std::size_t>(status.total_count_change);
  }

  void wait(std::chrono::milliseconds timeout) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [this] { return has_arrived_; });
    has_arrived_ = false;
  }
  std::size_t lost() const { return lost_; }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool has_arrived_ = false;
  std::atomic<std::size_t> lost_ = 0;
};

DataReaderQos reader_qos(Delivery delivery) {
  DataReaderQos qos;
  const bool is_newest = delivery == Delivery::newest;
  qos.reliability().kind = is_newest ? BEST_EFFORT_RELIABILITY_QOS : RELIABLE_RELIABILITY_QOS;
  qos.durability().kind =
      delivery == Delivery::kept ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = is_newest                    ? newest_received
                        : delivery == Delivery::kept ? kept_received
                                                     : reliable_received;
  answer_at_once(qos.reliable_reader_qos().times);
  // What a message claims to be is not allocated: each has the room that the type says, which the
  // machine gives where it is written.
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_MEMORY_MODE;
  keep_at_most(qos.history().depth, qos.resource_limits());
  return qos;
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

struct Subscriptions::Implementation {
  std::shared_ptr<Node> node;
  Arrivals arrivals;
  Subscriber* subscriber = nullptr;
  std::vector<DataReader*> readers;
  std::size_t next = 0;  ///< the reader whose turn it is

  bool take_waiting(Received& received) {
    for (std::size_t i = 0; i < readers.size(); ++i) {
      const std::size_t topic = (next + i) % readers.size();
      SampleInfo info;
      while (is_done(readers[topic]->take_next_sample(&received.bytes, &info))) {
        if (!info.valid_data) continue;
        received.topic = topic;
        received.arrival_s = now_s();
        next = topic + 1;
        return true;
      }
    }
    return false;
  }
};

Subscriptions::Subscriptions(std::shared_ptr<Node> node)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->node = std::move(node);
  auto* const participant = implementation_->node->implementation().participant;
  implementation_->subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  expect_made(implementation_->subscriber, "no subscriber can be made");
}

Subscriptions::~Subscriptions() {
  for (DataReader* const reader : implementation_->readers) {
    implementation_->subscriber->delete_datareader(reader);
  }
  implementation_->node->implementation().participant->delete_subscriber(
      implementation_->subscriber);
}

std::size_t Subscriptions::add(const diminish::dds::Topic& topic, Delivery delivery) {
  auto& node = implementation_->node->implementation();
  DataReaderQos qos = reader_qos(delivery);
  qos.data_sharing(node.data_sharing(delivery));
  DataReader* const reader = implementation_->subscriber->create_datareader(
      node.topic(topic), qos, &implementation_->arrivals);
  expect_made(reader, topic.name + " cannot be read" + node.refusal);
  implementation_->readers.push_back(reader);
  return implementation_->readers.size() - 1;
}

bool Subscriptions::take(Received& received, std::chrono::milliseconds timeout) {
  if (implementation_->take_waiting(received)) return true;
  implementation_->arrivals.wait(timeout);
  return implementation_->take_waiting(received);
}

std::size_t Subscriptions::lost() const {
  return implementation_->arrivals.lost();
}

std::size_t Subscriptions::senders(std::size_t topic) const {
  SubscriptionMatchedStatus status;
  implementation_->readers[topic]->get_subscription_matched_status(status);
  return static_cast<std::size_t>(status.current_count);
}

}  // namespace diminish::dds
