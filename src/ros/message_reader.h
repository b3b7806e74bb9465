#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

namespace diminish::ros {

/// How messages are written. `cdr`: ROS 2, on the wire and in its bags (OMG, DDS-XTypes 1.3, 7.4.1
/// and 7.4.2: plain CDR, versions 1 and 2, either byte order). `ros1`: packed, least significant
/// byte first.
enum class Wire { cdr, ros1 };

/// Reads a message's fields in order. What is there is not trusted: each function throws Error
/// (input) where the message ends too early or a count is above its limit. Nothing is allocated for
/// what a count merely claims.
class MessageReader {
 public:
  /// The bytes must outlive this, and what `bytes` returns.
  MessageReader(std::span<const std::uint8_t> message, Wire wire);

  Wire wire() const { return wire_; }

  template <class Number>
  Number number() {
    static_assert(std::is_arithmetic_v<Number>);
    std::array<std::uint8_t, sizeof(Number)> raw;
    align(sizeof(Number));
    std::memcpy(raw.data(), take(sizeof(Number)).data(), sizeof(Number));
    if (is_swapped_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Number>(raw);
  }
  template <std::size_t count>
  std::array<double, count> doubles() {
    std::array<double, count> values;
    for (double& value : values) value = number<double>();
    return values;
  }

  /// A text of at most `most` bytes.
  std::string text(std::size_t most = 256);
  /// A sequence of bytes: a part of the message.
  std::span<const std::uint8_t> bytes();
  /// The length of a sequence whose elements have at least `least_bytes` each, at most `most` of
  /// them.
  std::size_t count(std::size_t most, std::size_t least_bytes);

 private:
  void align(std::size_t size);
  std::span<const std::uint8_t> take(std::size_t count);

  std::span<const std::uint8_t> rest_;
  std::size_t at_ = 0;  ///< from where alignment counts
  std::size_t most_alignment_ = 1;
  bool is_swapped_ = false;
  Wire wire_;
};

}  // namespace diminish::ros
