#pragma once

#include <cstdint>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <string>
#include <vector>

namespace diminish::dds {

/// A type of DDS whose samples are the messages' bytes: std::vector<std::uint8_t>, the
/// encapsulation included.
class PayloadType : public eprosima::fastdds::dds::TopicDataType {
 public:
  /// most_bytes: what a reader has room for.
  PayloadType(const std::string& name, std::size_t most_bytes);

  /// Room for the largest is kept, so that senders may write where readers read.
  bool is_bounded() const override { return true; }
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  /// False if the sender has begun to write its next message there.
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  /// Whether a message that was taken from a payload is still in it.
  static bool is_still_there(const std::vector<std::uint8_t>& taken,
                             const eprosima::fastrtps::rtps::SerializedPayload_t& payload);
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override;
  void deleteData(void* data) override;
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace diminish::dds
