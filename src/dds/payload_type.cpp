#include "dds/payload_type.h"

#include <cstdint>
#include <cstring>
#include <vector>

namespace diminish::dds {
namespace {

using Bytes = std::vector<std::uint8_t>;
using eprosima::fastrtps::rtps::SerializedPayload_t;

constexpr std::size_t encapsulation_bytes = 4;

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
  std::memcpy(payload->data, bytes.data(), bytes.size());
  payload->length = static_cast<std::uint32_t>(bytes.size());
  return true;
}

bool PayloadType::deserialize(SerializedPayload_t* payload, void* data) {
  static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
  return true;
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
