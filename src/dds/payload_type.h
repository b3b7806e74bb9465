#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <string>

namespace diminish::dds {

/// A type of DDS whose samples are the messages' bytes: std::vector<std::uint8_t>, the
/// encapsulation included.
class PayloadType : public eprosima::fastdds::dds::TopicDataType {
 public:
  /// most_bytes: what a reader has room for.
  PayloadType(const std::string& name, std::size_t most_bytes);

  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override;
  void deleteData(void* data) override;
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace diminish::dds
