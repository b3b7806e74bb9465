#pragma once

#include <cstddef>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <string>
#include <vector>

// Fast DDS 3 (Debian 13) renamed headers, namespaces and members of Fast DDS 2 (Debian 12, Ubuntu
// 24.04). What differs stands here, and nowhere else.

#if __has_include(<fastdds/rtps/writer/WriterDiscoveryStatus.hpp>)
#define DIMINISH_FAST_DDS_3
#include <fastdds/dds/core/ReturnCode.hpp>
#include <fastdds/rtps/builtin/data/PublicationBuiltinTopicData.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.hpp>
#include <fastdds/rtps/writer/WriterDiscoveryStatus.hpp>
#include <fastdds/utils/IPLocator.hpp>
#else
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#include <fastrtps/utils/IPLocator.h>
#endif

namespace diminish::dds {

#ifdef DIMINISH_FAST_DDS_3
namespace rtps = eprosima::fastdds::rtps;
#else
namespace rtps = eprosima::fastrtps::rtps;
#endif

/// A type of DDS whose samples are messages' bytes, the encapsulation included.
class BytesType : public eprosima::fastdds::dds::TopicDataType {
 public:
  using Bytes = std::vector<std::uint8_t>;

  /// most_bytes: what a reader has room for.
  BytesType(const std::string& name, std::size_t most_bytes);

  /// False if there is no room for them, or they are no message.
  virtual bool write(const Bytes& bytes, rtps::SerializedPayload_t& payload) const = 0;
  virtual bool read(const rtps::SerializedPayload_t& payload, Bytes& bytes) const = 0;

#ifdef DIMINISH_FAST_DDS_3
  using Representation = eprosima::fastdds::dds::DataRepresentationId_t;

  bool serialize(const void* data, rtps::SerializedPayload_t& payload, Representation) override {
    return write(*static_cast<const Bytes*>(data), payload);
  }
  bool deserialize(rtps::SerializedPayload_t& payload, void* data) override {
    return read(payload, *static_cast<Bytes*>(data));
  }
  std::uint32_t calculate_serialized_size(const void* data, Representation) override {
    return static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size());
  }
  void* create_data() override {
    return new Bytes;
  }
  void delete_data(void* data) override {
    delete static_cast<Bytes*>(data);
  }
  bool compute_key(rtps::SerializedPayload_t&, rtps::InstanceHandle_t&, bool) override {
    return false;
  }
  bool compute_key(const void*, rtps::InstanceHandle_t&, bool) override {
    return false;
  }
#else
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    return write(*static_cast<const Bytes*>(data), *payload);
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    return read(*payload, *static_cast<Bytes*>(data));
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    const auto size = static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size());
    return [size] { return size; };
  }
  void* createData() override {
    return new Bytes;
  }
  void deleteData(void* data) override {
    delete static_cast<Bytes*>(data);
  }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override {
    return false;
  }
#endif

 protected:
#ifdef DIMINISH_FAST_DDS_3
  std::size_t most_bytes() const {
    return max_serialized_type_size;
  }
#else
  std::size_t most_bytes() const {
    return m_typeSize;
  }
#endif
};

inline BytesType::BytesType(const std::string& name, std::size_t most_bytes) {
#ifdef DIMINISH_FAST_DDS_3
  set_name(name);
  max_serialized_type_size = static_cast<std::uint32_t>(most_bytes);
#else
  setName(name.c_str());
  m_typeSize = static_cast<std::uint32_t>(most_bytes);
  m_isGetKeyDefined = false;
  auto_fill_type_information(false);
  auto_fill_type_object(false);
#endif
}

/// Hears of other participants' writers.
class WritersListener : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  struct Writer {
    rtps::GUID_t guid;
    std::string topic, type;
    bool is_gone;
  };
  virtual void on_writer(const Writer& writer) = 0;

#ifdef DIMINISH_FAST_DDS_3
  void on_data_writer_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                rtps::WriterDiscoveryStatus status,
                                const rtps::PublicationBuiltinTopicData& data, bool&) override {
    on_writer({data.guid, data.topic_name.to_string(), data.type_name.to_string(),
               status == rtps::WriterDiscoveryStatus::REMOVED_WRITER});
  }
#else
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant*,
                              rtps::WriterDiscoveryInfo&& data) override {
    on_writer({data.info.guid(), data.info.topicName().to_string(),
               data.info.typeName().to_string(),
               data.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER});
  }
#endif
};

/// Whether something was done.
template <class Code>
bool is_done(const Code& code) {
#ifdef DIMINISH_FAST_DDS_3
  return code == eprosima::fastdds::dds::RETCODE_OK;
#else
  return code == Code::RETCODE_OK;
#endif
}

/// times: of a reliable writer. What is lost is missed after `period_ns`, and sent again at once.
template <class Times>
void repair_within(std::uint32_t period_ns, Times& times) {
#ifdef DIMINISH_FAST_DDS_3
  times.heartbeat_period = {0, period_ns};
  times.nack_response_delay = {0, 0};
#else
  times.heartbeatPeriod = {0, period_ns};
  times.nackResponseDelay = {0, 0};
#endif
}

/// times: of a reliable reader. It says at once what it misses.
template <class Times>
void answer_at_once(Times& times) {
#ifdef DIMINISH_FAST_DDS_3
  times.heartbeat_response_delay = {0, 0};
#else
  times.heartbeatResponseDelay = {0, 0};
#endif
}

}  // namespace diminish::dds
