#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace diminish::ros {

/// A record of a bag is not larger.
inline constexpr std::size_t most_record_bytes = 1u << 30;

/// Reads bytes of a stream, in steps, so that a record that claims more than there is takes no more
/// memory than there is. False if the stream ends before. Throws Error (input) above
/// most_record_bytes.
bool read_bytes(std::istream& stream, std::uint64_t count, std::vector<std::uint8_t>& bytes);

/// Throws Error (input), "expected WHAT", if the stream does not begin with these bytes.
void expect_begin(std::istream& stream, std::string_view magic, const std::string& what);

/// Fields of a record, the least significant byte first. Each throws Error (input) at its end.
class Fields {
 public:
  explicit Fields(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  template <class Number>
  Number number() {
    Number value = 0;
    const auto raw = bytes(sizeof(Number));
    for (std::size_t i = sizeof(Number); i-- > 0;) {
      value = static_cast<Number>(static_cast<std::uint64_t>(value) << 8 | raw[i]);
    }
    return value;
  }
  std::span<const std::uint8_t> bytes(std::uint64_t count);
  /// A text with its length, of 32 bits, before it.
  std::string_view text();
  std::span<const std::uint8_t> rest() const { return rest_; }
  bool empty() const { return rest_.empty(); }

 private:
  std::span<const std::uint8_t> rest_;
};

/// Decompresses a chunk: "bz2", "lz4" (frames) or "zstd". Throws Error (input) if it does not have
/// exactly `size` bytes, or this build is without the library.
void decompress(std::string_view method, std::span<const std::uint8_t> from, std::uint64_t size,
                std::vector<std::uint8_t>& to);

}  // namespace diminish::ros
