#pragma once

#include <cstdint>
#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "dds/dds.h"
#include "dds/fast_dds.h"
#include "dds/leftovers.h"

namespace diminish::dds {

/// Keeps what is heard of other participants' writers. Called by DDS's threads; it throws nothing.
class Discovery : public WritersListener {
 public:
  void on_writer(const Writer& writer) override;
  std::vector<Topic> topics() const;

 private:
  mutable std::mutex mutex_;
  std::map<rtps::GUID_t, Topic> writers_;
};

/// A participant, and its topics and types: each exists once, whoever uses it.
struct Node::Implementation {
  explicit Implementation(const Network& network);
  ~Implementation();

  /// The topic, made if there is none. Throws Error. What is returned is the participant's.
  eprosima::fastdds::dds::Topic* topic(const Topic& topic);

  /// Of Fast DDS's flow controllers, the one for what is sent; null: none.
  const char* flow_controller = nullptr;
  /// What programs must have in common to read messages where their sender wrote them; nothing: all
  /// messages are sent. Fast DDS cuts what goes through its transports, shared memory too, into
  /// pieces of 64 kB.
  std::optional<std::uint16_t> shared_domain;
  /// How a topic's messages are handed over.
  eprosima::fastdds::dds::DataSharingQosPolicy data_sharing(Delivery delivery) const;
  /// Why a topic may be refused where there are keys.
  std::string refusal;
  std::mutex mutex;
  Discovery discovery;
  eprosima::fastdds::dds::DomainParticipant* participant = nullptr;
  std::optional<SharedMark> mark;
};

/// Room for so many messages, each of which takes it where it is written.
void keep_at_most(int messages, eprosima::fastdds::dds::ResourceLimitsQosPolicy& limits);

/// Throws Error (device) that says what could not be made.
void expect_made(const void* made, const std::string& what);

}  // namespace diminish::dds
