#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace diminish::dds {

// ROS 2's wire, DDS, through Fast DDS. Messages are bytes here: CDR with its four bytes of
// encapsulation (ros/messages.h reads and writes them).

/// Where messages go.
struct Network {
  int domain = 0;  ///< ROS_DOMAIN_ID
  /// The address of the machine's network interface to use. Empty: this machine only, and no other
  /// sees anything.
  std::string interface;
  /// Whether processes of this machine hand messages over through shared memory.
  bool shared_memory = true;
  /// Mbit/s that this process sends at most; 0: as fast as it can. What there is no time for is
  /// left out, message by message.
  double most_mbits = 0;
  /// The folder with this participant's keys (KeyFiles): only those with keys of the same authority
  /// see it, and are seen. Empty: no keys, everybody who has none.
  std::string keys;
  /// Messages travel in pieces of one packet of Ethernet each, so that one that gets lost is all
  /// that has to be sent again. Otherwise in pieces of up to 64 kB, which cost less.
  bool in_packets = false;

  /// Whether others are programs of this machine, which hand messages over through shared memory.
  bool is_within_machine() const { return shared_memory && interface.empty() && keys.empty(); }
};

/// ROS_DOMAIN_ID from the environment, else 0. Throws Error if it is not a number from 0 to 232.
int default_domain();

/// A topic by ROS's name ("/camera/color/image_raw") and by its type's name on the wire.
struct Topic {
  std::string name, type;
};

/// A participant: what a process is to others. All that name the same network share one.
class Node {
 public:
  /// Throws Error (device) if there is none to be had.
  static std::shared_ptr<Node> open(const Network& network);
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  struct Implementation;
  Implementation& implementation() { return *implementation_; }

  /// The topics that other participants send to, as far as they have been met: ROS's names, each
  /// once. At most a thousand. Names are whatever others say.
  std::vector<Topic> topics_of_others() const;

 private:
  explicit Node(const Network& network);
  std::unique_ptr<Implementation> implementation_;
};

/// The name on the wire: "rt/camera/color/image_raw".
std::string wire_name(const std::string& ros_name);

/// A picture of 4096x2160 in 24 bits. What claims to be larger is dropped before it takes memory.
inline constexpr std::size_t most_message_bytes = 32u << 20;

/// How a topic's messages are kept.
enum class Delivery {
  newest,    ///< best effort, the last few: as sensors' drivers send
  reliable,  ///< repeated where one was lost
  kept,      ///< reliable, and the last ones also go to those who come later
};

struct Received {
  std::size_t topic = 0;  ///< as `add` returned
  double arrival_s = 0;   ///< on the monotonic clock
  std::vector<std::uint8_t> bytes;
};

/// Several topics, which one thread reads.
class Subscriptions {
 public:
  explicit Subscriptions(std::shared_ptr<Node> node);
  ~Subscriptions();
  Subscriptions(const Subscriptions&) = delete;
  Subscriptions& operator=(const Subscriptions&) = delete;

  /// Messages above `most_message_bytes` are dropped. Throws Error.
  std::size_t add(const Topic& topic, Delivery delivery);
  /// Waits up to about `timeout` for a message, and takes it. `received` keeps its memory. Of
  /// several waiting ones the topics take turns.
  bool take(Received& received, std::chrono::milliseconds timeout);
  /// Messages that were lost on the way, or that newer ones replaced before they were taken.
  std::size_t lost() const;
  /// How many send to a topic.
  std::size_t senders(std::size_t topic) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// A topic that this process sends to.
class Publication {
 public:
  /// Throws Error.
  Publication(std::shared_ptr<Node> node, const Topic& topic, Delivery delivery);
  ~Publication();
  Publication(const Publication&) = delete;
  Publication& operator=(const Publication&) = delete;

  void send(const std::vector<std::uint8_t>& message);
  /// How many listen.
  std::size_t listeners() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish::dds
