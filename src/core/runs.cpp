#include "core/runs.h"

namespace diminish::runs_detail {

int find_other_far(const std::uint8_t* bytes, int x, int end, std::uint8_t value) {
  constexpr int step = 4 * word_bytes;
  for (; x + step <= end; x += step) {
    std::uint64_t any = 0;
    for (int i = 0; i < step; i += word_bytes) any |= differences(bytes + x + i, value);
    if (any != 0) break;
  }
  for (; x + word_bytes <= end; x += word_bytes) {
    const std::uint64_t word = differences(bytes + x, value);
    if (word != 0) return x + std::countr_zero(word) / 8;
  }
  if (x >= end) return end;
  const std::uint64_t word = differences(bytes + end - word_bytes, value);
  return word == 0 ? end : end - word_bytes + std::countr_zero(word) / 8;
}

int find_equal_far(const std::uint8_t* bytes, int x, int end, std::uint8_t value) {
  if (x >= end) return end;
  const void* const found = std::memchr(bytes + x, value, static_cast<std::size_t>(end - x));
  return found == nullptr ? end : static_cast<int>(static_cast<const std::uint8_t*>(found) - bytes);
}

}  // namespace diminish::runs_detail
