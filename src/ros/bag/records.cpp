#include "ros/bag/records.h"

#include <fmt/format.h>

#include <algorithm>

#include "diminish/error.h"

namespace diminish::ros {
namespace {

constexpr std::size_t step_bytes = 1 << 20;

}  // namespace

bool read_bytes(std::istream& stream, std::uint64_t count, std::vector<std::uint8_t>& bytes) {
  if (count > most_record_bytes) {
    throw Error(Error::input, fmt::format("expected records of at most {} bytes, got {}",
                                          most_record_bytes, count));
  }
  bytes.clear();
  while (bytes.size() < count) {
    const std::size_t before = bytes.size();
    // Twice as much each time: what is read is copied once or twice.
    const std::size_t step = std::min<std::size_t>(count - before, std::max(step_bytes, before));
    bytes.resize(before + step);
    if (!stream.read(reinterpret_cast<char*>(bytes.data() + before),
                     static_cast<std::streamsize>(step))) {
      return false;
    }
  }
  return true;
}

void expect_begin(std::istream& stream, std::string_view magic, const std::string& what) {
  std::vector<std::uint8_t> first;
  const auto is_same = [](std::uint8_t byte, char expected) {
    return byte == static_cast<std::uint8_t>(expected);
  };
  if (!read_bytes(stream, magic.size(), first) ||
      !std::equal(first.begin(), first.end(), magic.begin(), is_same)) {
    throw Error(Error::input, "expected " + what);
  }
}

std::span<const std::uint8_t> Fields::bytes(std::uint64_t count) {
  if (count > rest_.size()) {
    throw Error(Error::input, fmt::format("a record ends too early: expected {} more bytes, got {}",
                                          count, rest_.size()));
  }
  const auto taken = rest_.first(count);
  rest_ = rest_.subspan(count);
  return taken;
}

std::string_view Fields::text() {
  const auto raw = bytes(number<std::uint32_t>());
  return {reinterpret_cast<const char*>(raw.data()), raw.size()};
}

}  // namespace diminish::ros
