#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "ros/message_reader.h"

namespace diminish::ros {

/// Writes a message's fields in order, the least significant byte first. The counterpart of
/// MessageReader.
class MessageWriter {
 public:
  /// Begins a message in `message`, whose memory is used again.
  MessageWriter(std::vector<std::uint8_t>& message, Wire wire);

  Wire wire() const { return wire_; }

  template <class Number>
  void number(Number value) {
    static_assert(std::is_arithmetic_v<Number>);
    auto raw = std::bit_cast<std::array<std::uint8_t, sizeof(Number)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    align(sizeof(Number));
    append(raw);
  }
  template <std::size_t count>
  void doubles(const std::array<double, count>& values) {
    for (const double value : values) number(value);
  }
  void text(std::string_view text);
  void bytes(std::span<const std::uint8_t> bytes);
  /// A sequence of bytes that the caller fills: valid until the next field.
  std::span<std::uint8_t> reserve_bytes(std::size_t count);
  void count(std::size_t length) { number(static_cast<std::uint32_t>(length)); }

 private:
  void align(std::size_t size);
  void append(std::span<const std::uint8_t> bytes) {
    message_.insert(message_.end(), bytes.begin(), bytes.end());
  }

  std::vector<std::uint8_t>& message_;
  Wire wire_;
};

}  // namespace diminish::ros
