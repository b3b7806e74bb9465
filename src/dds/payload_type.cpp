#include "dds/payload_type.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <vector>

namespace diminish::dds {
namespace {

using Bytes = std::vector<std::uint8_t>;
using eprosima::fastrtps::rtps::SerializedPayload_t;

constexpr std::size_t encapsulation_bytes = 4;
/// What differs from message to message, such as an image's stamp, stands in the first so many.
constexpr std::size_t header_bytes = 32;

}  // namespace

PayloadType::PayloadType(const std::string& name, std::size_t most_bytes) {
  setName(name.c_str());
  m_typeSize = static_cast<std::uint32_t>(most_bytes);
  m_isGetKeyDefined = false;
  auto_fill_type_information(false);
  auto_fill_type_object(false);
}

bool PayloadType::serialize(void* data, SerializedPayload_t* payload) {
  const Bytes& bytes = *static_cast<const Bytes*>(data);
  if (bytes.size() < encapsulation_bytes || bytes.size() > payload->max_size) return false;
  payload->encapsulation = bytes[1] == 0 ? CDR_BE : CDR_LE;
  // First what tells who still reads the message that was there before that it is gone.
  const std::size_t header = std::min(bytes.size(), header_bytes);
  std::memcpy(payload->data, bytes.data(), header);
  std::atomic_thread_fence(std::memory_order_release);
  std::memcpy(payload->data + header, bytes.data() + header, bytes.size() - header);
  payload->length = static_cast<std::uint32_t>(bytes.size());
  return true;
}

bool PayloadType::deserialize(SerializedPayload_t* payload, void* data) {
  if (payload->length > m_typeSize) return false;
  auto& bytes = *static_cast<Bytes*>(data);
  bytes.assign(payload->data, payload->data + payload->length);
  return is_still_there(bytes, *payload);
}

// DDS has looked before the bytes were taken. Where the sender writes its next message, the header
// comes first.
bool PayloadType::is_still_there(const std::vector<std::uint8_t>& taken,
                                 const SerializedPayload_t& payload) {
  std::atomic_thread_fence(std::memory_order_acquire);
  return std::memcmp(taken.data(), payload.data, std::min(taken.size(), header_bytes)) == 0;
}

std::function<uint32_t()> PayloadType::getSerializedSizeProvider(void* data) {
  const auto size = static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size());
  return [size] { return size; };
}

void* PayloadType::createData() {
  return new Bytes;
}

void PayloadType::deleteData(void* data) {
  delete static_cast<Bytes*>(data);
}

}  // namespace diminish::dds
