#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "camera/sender_clock.h"
#include "dds/dds.h"
#include "ros/transform_buffer.h"

namespace diminish {

/// Hears /tf and /tf_static. Its own thread reads; any may ask.
class TransformListener {
 public:
  /// All that name the same network and clock share one. Throws Error.
  static std::shared_ptr<TransformListener> open(const dds::Network& network,
                                                 Ros2Address::Clock clock);
  ~TransformListener();
  TransformListener(const TransformListener&) = delete;
  TransformListener& operator=(const TransformListener&) = delete;

  /// What is known of a transform at a time on the monotonic clock. Waits up to `wait_s` for a
  /// later one; not at all where the newest is too old for a later one to help (`most_gap_s`).
  ros::TransformBuffer::Found find(const std::string& to, const std::string& from, double time_s,
                                   double most_gap_s, double wait_s);
  /// Why the last message could not be used; empty where there was none such. Read once.
  std::string take_problem();

 private:
  TransformListener(std::shared_ptr<dds::Node> node, Ros2Address::Clock clock);
  void work();
  void take(const dds::Received& received);

  SenderClock clock_;
  dds::Subscriptions subscriptions_;
  std::size_t static_topic_ = 0;
  std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  ros::TransformBuffer buffer_;
  std::string problem_;
  std::atomic<bool> is_stopped_ = false;
  std::thread thread_;  ///< last: it uses all of the above
};

}  // namespace diminish
