#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

namespace diminish {

namespace runs_detail {
/// From x on; the eight bytes before it are `value`.
int find_other_far(const std::uint8_t* bytes, int x, int end, std::uint8_t value);
int find_equal_far(const std::uint8_t* bytes, int x, int end, std::uint8_t value);

inline constexpr int word_bytes = sizeof(std::uint64_t);
inline constexpr std::uint64_t every_byte = 0x0101010101010101U;

/// Eight bytes, each XORed with `value`.
inline std::uint64_t differences(const std::uint8_t* bytes, std::uint8_t value) {
  static_assert(std::endian::native == std::endian::little, "the first byte is the lowest");
  std::uint64_t word;
  std::memcpy(&word, bytes, sizeof(word));
  return word ^ (value * every_byte);
}
}  // namespace runs_detail

/// The index of the first of the bytes [x, end) that is not `value`; `end` if there is none.
inline int find_other(const std::uint8_t* bytes, int x, int end, std::uint8_t value) {
  if (x + runs_detail::word_bytes <= end) {
    const std::uint64_t word = runs_detail::differences(bytes + x, value);
    if (word != 0) return x + std::countr_zero(word) / 8;
    return runs_detail::find_other_far(bytes, x + runs_detail::word_bytes, end, value);
  }
  while (x < end && bytes[x] == value) ++x;
  return x;
}

/// The index of the first of the bytes [x, end) that is `value`; `end` if there is none.
inline int find_equal(const std::uint8_t* bytes, int x, int end, std::uint8_t value) {
  if (x + runs_detail::word_bytes <= end) {
    const std::uint64_t word = runs_detail::differences(bytes + x, value);
    // The lowest of these bits lies in the lowest byte that is 0. Higher bits may be wrong.
    const std::uint64_t zeros =
        (word - runs_detail::every_byte) & ~word & (0x80 * runs_detail::every_byte);
    if (zeros != 0) return x + std::countr_zero(zeros) / 8;
    x += runs_detail::word_bytes;
  }
  return runs_detail::find_equal_far(bytes, x, end, value);
}

/// Whether `count` bytes are all `value`; for counts known to the compiler.
template <int count>
bool all_equal(const std::uint8_t* bytes, std::uint8_t value) {
  if constexpr (count == sizeof(std::uint32_t)) {
    std::uint32_t word;
    std::memcpy(&word, bytes, sizeof(word));
    return word == static_cast<std::uint32_t>(value * runs_detail::every_byte);
  }
  static_assert(count == sizeof(std::uint32_t) || count % runs_detail::word_bytes == 0);
  std::uint64_t any = 0;
  for (int i = 0; i < count; i += runs_detail::word_bytes) {
    any |= runs_detail::differences(bytes + i, value);
  }
  return any == 0;
}

/// The index of the first of the bytes [x, end) that lacks a bit; `end` if there is none.
inline int find_without(const std::uint8_t* bytes, int x, int end, std::uint8_t bit) {
  for (; x + runs_detail::word_bytes <= end; x += runs_detail::word_bytes) {
    const std::uint64_t lacking =
        runs_detail::differences(bytes + x, 0xFF) & (bit * runs_detail::every_byte);
    if (lacking != 0) return x + std::countr_zero(lacking) / 8;
  }
  while (x < end && (bytes[x] & bit) != 0) ++x;
  return x;
}

/// Whether one of `count` bytes is less than `least`, which is 128 at most; for counts known to the
/// compiler.
template <int count>
bool is_any_below(const std::uint8_t* bytes, int least) {
  static_assert(count % runs_detail::word_bytes == 0);
  const std::uint64_t leasts = static_cast<std::uint64_t>(least) * runs_detail::every_byte;
  std::uint64_t below = 0;
  for (int i = 0; i < count; i += runs_detail::word_bytes) {
    const std::uint64_t word = runs_detail::differences(bytes + i, 0);
    // The lowest of these bits lies in the lowest byte that is less. Higher bits may be wrong.
    below |= (word - leasts) & ~word;
  }
  return (below & (0x80 * runs_detail::every_byte)) != 0;
}

/// Calls visit(x) for each of the `count` bytes that is not 0, in order.
template <class Visit>
void for_each_set(const std::uint8_t* bytes, int count, const Visit& visit) {
  for (int x = 0; (x = find_other(bytes, x, count, 0)) < count; ++x) visit(x);
}

/// The pixels of a mask that are not 0, or those that are 0.
enum class Pixels { set, clear };

/// Calls visit(first, last) for each maximal run [first, last) of bytes in [begin, end) that are
/// `value`, in order.
template <class Visit>
void for_each_run(const std::uint8_t* bytes, int begin, int end, std::uint8_t value,
                  const Visit& visit) {
  for (int last = begin; last < end;) {
    const int first = find_equal(bytes, last, end, value);
    if (first == end) return;
    last = find_other(bytes, first, end, value);
    visit(first, last);
  }
}
/// The same of a mask's pixels.
template <class Visit>
void for_each_run(const std::uint8_t* bytes, int begin, int end, Pixels pixels,
                  const Visit& visit) {
  if (pixels == Pixels::clear) {
    for_each_run(bytes, begin, end, std::uint8_t{0}, visit);
    return;
  }
  for (int last = begin; last < end;) {
    const int first = find_other(bytes, last, end, 0);
    if (first == end) return;
    last = find_equal(bytes, first, end, 0);
    visit(first, last);
  }
}

/// Calls visit(i) for each bit i that is set, from the lowest to the highest.
template <class Word, class Visit>
void for_each_bit(Word bits, const Visit& visit) {
  for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits));
}

/// Calls visit(first, last) for each maximal run [first, last) of set bits in a row. Each of its
/// `words` words holds 32 pixels, the first one in the lowest bit.
template <class Visit>
void for_each_run(const std::uint32_t* bits, int words, const Visit& visit) {
  constexpr int width = 32;
  int first = -1;
  for (int word = 0; word < words; ++word) {
    const std::uint32_t value = bits[word];
    if (value == (first < 0 ? 0U : ~0U)) continue;
    for (int bit = 0; bit < width;) {
      const std::uint32_t rest = (first < 0 ? value : ~value) >> bit;
      if (rest == 0) break;
      bit += std::countr_zero(rest);
      if (first < 0) {
        first = word * width + bit;
      } else {
        visit(first, word * width + bit);
        first = -1;
      }
    }
  }
  if (first >= 0) visit(first, words * width);
}

}  // namespace diminish
