#include "ros/message_reader.h"

#include <fmt/format.h>

#include "diminish/error.h"

namespace diminish::ros {
namespace {

constexpr std::size_t header_bytes = 4;

[[noreturn]] void fail(const std::string& what) {
  throw Error(Error::input, what);
}

}  // namespace

MessageReader::MessageReader(std::span<const std::uint8_t> message, Wire wire)
    : rest_(message), wire_(wire) {
  constexpr bool is_big = std::endian::native == std::endian::big;
  if (wire == Wire::ros1) {
    is_swapped_ = is_big;
    return;
  }
  const auto header = take(header_bytes);
  // DDS-XTypes 1.3, table 60: CDR_BE, CDR_LE, CDR2_BE and CDR2_LE.
  const unsigned kind = header[0] * 256u + header[1];
  if (kind != 0 && kind != 1 && kind != 6 && kind != 7) {
    fail(fmt::format("expected a message in plain CDR, got encapsulation {}", kind));
  }
  most_alignment_ = kind < 6 ? 8 : 4;
  is_swapped_ = (kind % 2 == 0) != is_big;
  at_ = 0;
}

void MessageReader::align(std::size_t size) {
  const std::size_t to = std::min(size, most_alignment_);
  const std::size_t past = at_ % to;
  if (past != 0) take(to - past);
}

std::span<const std::uint8_t> MessageReader::take(std::size_t count) {
  if (count > rest_.size()) {
    fail(fmt::format("the message ends too early: expected {} more bytes, got {}", count,
                     rest_.size()));
  }
  const auto taken = rest_.first(count);
  rest_ = rest_.subspan(count);
  at_ += count;
  return taken;
}

std::string MessageReader::text(std::size_t most) {
  const auto length = number<std::uint32_t>();
  if (length > most + 1) {
    fail(fmt::format("expected a text of at most {} bytes, got {}", most, length));
  }
  const auto raw = take(length);
  // CDR counts the zero at the end.
  const auto end = std::find(raw.begin(), raw.end(), std::uint8_t{0});
  return {raw.begin(), end};
}

std::span<const std::uint8_t> MessageReader::bytes() {
  return take(number<std::uint32_t>());
}

std::size_t MessageReader::count(std::size_t most, std::size_t least_bytes) {
  const auto length = number<std::uint32_t>();
  if (length > most || length * least_bytes > rest_.size()) {
    fail(fmt::format("expected a list of at most {} entries, got {}",
                     std::min(most, rest_.size() / std::max<std::size_t>(least_bytes, 1)), length));
  }
  return length;
}

}  // namespace diminish::ros
