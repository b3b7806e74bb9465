#include "dds/payload_type.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>

namespace diminish::dds {
namespace {

constexpr std::size_t encapsulation_bytes = 4;
/// What differs from message to message, such as an image's stamp, stands in the first so many.
constexpr std::size_t header_bytes = 32;

}  // namespace

bool PayloadType::write(const Bytes& bytes, rtps::SerializedPayload_t& payload) const {
  if (bytes.size() < encapsulation_bytes || bytes.size() > payload.max_size) return false;
  payload.encapsulation = bytes[1] == 0 ? CDR_BE : CDR_LE;
  // First what tells who still reads the message that was there before that it is gone.
  const std::size_t header = std::min(bytes.size(), header_bytes);
  std::memcpy(payload.data, bytes.data(), header);
  std::atomic_thread_fence(std::memory_order_release);
  std::memcpy(payload.data + header, bytes.data() + header, bytes.size() - header);
  payload.length = static_cast<std::uint32_t>(bytes.size());
  return true;
}

bool PayloadType::read(const rtps::SerializedPayload_t& payload, Bytes& bytes) const {
  if (payload.length > most_bytes()) return false;
  bytes.assign(payload.data, payload.data + payload.length);
  return is_still_there(bytes, payload);
}

// DDS has looked before the bytes were taken. Where the sender writes its next message, the header
// comes first.
bool PayloadType::is_still_there(const Bytes& taken, const rtps::SerializedPayload_t& payload) {
  std::atomic_thread_fence(std::memory_order_acquire);
  return std::memcmp(taken.data(), payload.data, std::min(taken.size(), header_bytes)) == 0;
}

}  // namespace diminish::dds
