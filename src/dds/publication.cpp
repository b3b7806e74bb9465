#include <cstdint>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>

#include "dds/node.h"

namespace diminish::dds {
namespace {

using namespace eprosima::fastdds::dds;

constexpr int newest_sent = 2;
/// Of what others read where it was written: they have the time of so many messages to do so.
constexpr int newest_shared = 4;
/// Of what may have to be sent again.
constexpr int reliable_sent = 8;
constexpr int kept_sent = 16;
/// While somebody has not received all, it is asked this often what is missing.
constexpr std::uint32_t repair_ns = 5'000'000;

DataWriterQos writer_qos(Delivery delivery, const DataSharingQosPolicy& data_sharing) {
  DataWriterQos qos;
  qos.reliability().kind =
      delivery == Delivery::newest ? BEST_EFFORT_RELIABILITY_QOS : RELIABLE_RELIABILITY_QOS;
  qos.durability().kind =
      delivery == Delivery::kept ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = delivery == Delivery::kept       ? kept_sent
                        : delivery == Delivery::reliable ? reliable_sent
                                                         : newest_sent;
  // What is lost is missed, and sent again, within some milliseconds, not seconds.
  repair_within(repair_ns, qos.reliable_writer_qos().times);
  // Large messages go in pieces, on a thread of their own.
  qos.publish_mode().kind = ASYNCHRONOUS_PUBLISH_MODE;
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
  qos.data_sharing(data_sharing);
  if (data_sharing.kind() != OFF) {
    qos.history().depth = newest_shared;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_MEMORY_MODE;
    keep_at_most(newest_shared, qos.resource_limits());
  }
  return qos;
}

}  // namespace

struct Publication::Implementation {
  std::shared_ptr<Node> node;
  Publisher* publisher = nullptr;
  DataWriter* writer = nullptr;
};

Publication::Publication(std::shared_ptr<Node> node, const diminish::dds::Topic& topic,
                         Delivery delivery)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.node = std::move(node);
  auto& inner = self.node->implementation();
  DataWriterQos qos = writer_qos(delivery, inner.data_sharing(delivery));
  if (inner.flow_controller) qos.publish_mode().flow_controller_name = inner.flow_controller;
  self.publisher = inner.participant->create_publisher(PUBLISHER_QOS_DEFAULT);
  expect_made(self.publisher, "no publisher can be made");
  self.writer = self.publisher->create_datawriter(inner.topic(topic), qos);
  expect_made(self.writer, topic.name + " cannot be written" + inner.refusal);
}

Publication::~Publication() {
  if (implementation_->writer)
    implementation_->publisher->delete_datawriter(implementation_->writer);
  implementation_->node->implementation().participant->delete_publisher(implementation_->publisher);
}

void Publication::send(const std::vector<std::uint8_t>& message) {
  // Fast DDS takes what it only reads as non-const.
  implementation_->writer->write(const_cast<std::vector<std::uint8_t>*>(&message));
}

std::size_t Publication::listeners() const {
  PublicationMatchedStatus status;
  implementation_->writer->get_publication_matched_status(status);
  return static_cast<std::size_t>(status.current_count);
}

}  // namespace diminish::dds
