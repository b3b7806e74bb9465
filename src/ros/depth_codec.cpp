#include "ros/depth_codec.h"

#include <algorithm>
#include <array>

#include "diminish/error.h"

namespace diminish::ros {
namespace {

constexpr int bits_a_nibble = 4;
constexpr int nibbles_a_word = 8;
constexpr std::size_t word_bytes = 4;
constexpr std::uint32_t more_follow = 8;

/// A number's nibbles, the first one in the highest place, and how many there are.
struct Code {
  std::uint16_t nibbles = 0;
  std::uint16_t count = 0;
};

constexpr std::uint32_t coded_numbers = 1 << 12;  // four nibbles

constexpr Code code_of(std::uint32_t number) {
  Code code;
  do {
    const std::uint32_t rest = number >> 3;
    code.nibbles = static_cast<std::uint16_t>(code.nibbles << bits_a_nibble | (number & 7) |
                                              (rest != 0 ? more_follow : 0));
    ++code.count;
    number = rest;
  } while (number != 0);
  return code;
}

const std::array<Code, coded_numbers>& codes() {
  static const auto table = [] {
    std::array<Code, coded_numbers> made;
    for (std::uint32_t i = 0; i < coded_numbers; ++i) made[i] = code_of(i);
    return made;
  }();
  return table;
}

/// Words of eight nibbles, the first nibble in the highest place, the least significant byte first.
class NibbleWriter {
 public:
  explicit NibbleWriter(std::uint8_t* to) : to_(to) {}

  void number(std::uint32_t number) {
    while (number >= coded_numbers) {
      put((number & 7) | more_follow, 1);
      number >>= 3;
    }
    put(codes_[number].nibbles, codes_[number].count);
  }
  std::uint8_t* finish() {
    if (held_ > 0) put(0, nibbles_a_word - held_);
    return to_;
  }

 private:
  void put(std::uint32_t nibbles, int count) {
    pending_ = pending_ << (bits_a_nibble * count) | nibbles;
    held_ += count;
    if (held_ < nibbles_a_word) return;
    held_ -= nibbles_a_word;
    const auto word = static_cast<std::uint32_t>(pending_ >> (bits_a_nibble * held_));
    for (std::size_t i = 0; i < word_bytes; ++i) *to_++ = static_cast<std::uint8_t>(word >> 8 * i);
  }

  std::uint8_t* to_;
  const Code* const codes_ = codes().data();
  std::uint64_t pending_ = 0;
  int held_ = 0;
};

class NibbleReader {
 public:
  explicit NibbleReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  std::uint32_t number() {
    std::uint32_t number = 0;
    for (int shift = 0;; shift += 3) {
      if (held_ == 0) fill();
      const std::uint32_t nibble = pending_ >> 28;
      pending_ <<= bits_a_nibble;
      --held_;
      number |= (nibble & 7) << shift;
      if ((nibble & more_follow) == 0) return number;
      if (shift > 27) throw Error(Error::input, "compressed depth has a number above 32 bits");
    }
  }
  bool is_at_end() const { return rest_.empty(); }

 private:
  void fill() {
    if (rest_.size() < word_bytes) {
      throw Error(Error::input, "compressed depth ends too early");
    }
    pending_ = 0;
    for (std::size_t i = 0; i < word_bytes; ++i) pending_ |= std::uint32_t{rest_[i]} << 8 * i;
    rest_ = rest_.subspan(word_bytes);
    held_ = nibbles_a_word;
  }

  std::span<const std::uint8_t> rest_;
  std::uint32_t pending_ = 0;
  int held_ = 0;
};

/// Small numbers for small differences of either sign: 0, -1, 1, -2, 2 ...
std::uint32_t zigzag(int difference) {
  return static_cast<std::uint32_t>(difference) << 1 ^ static_cast<std::uint32_t>(difference >> 31);
}
/// The difference, modulo 2^32.
std::uint32_t from_zigzag(std::uint32_t number) {
  return number >> 1 ^ (0U - (number & 1));
}

}  // namespace

void compress_depth(const ImageView<std::uint16_t>& depth, std::vector<std::uint8_t>& bytes) {
  Image<std::uint16_t> joined;  // where rows have gaps
  const bool has_gaps = depth.stride() != depth.width() * std::ptrdiff_t{sizeof(std::uint16_t)};
  if (has_gaps) copy(depth, joined);
  const std::uint16_t* at = has_gaps ? joined.data() : depth.data();
  const std::size_t pixels =
      static_cast<std::size_t>(depth.width()) * static_cast<std::size_t>(depth.height());
  const std::uint16_t* const end = at + pixels;
  // A difference takes six nibbles at most; the two lengths of a gap and what follows it take no
  // more than the pixels of the gap would.
  const std::size_t before = bytes.size();
  bytes.resize(before + 3 * pixels + 4 * word_bytes);
  NibbleWriter writer(bytes.data() + before);
  const auto run = [&](const std::uint16_t* stop) {
    writer.number(static_cast<std::uint32_t>(stop - at));
    return stop;
  };
  int previous = 0;
  while (at != end) {
    at = run(std::find_if(at, end, [](std::uint16_t value) { return value != 0; }));
    for (const auto* const stop = run(std::find(at, end, std::uint16_t{0})); at != stop; ++at) {
      writer.number(zigzag(*at - previous));
      previous = *at;
    }
  }
  bytes.resize(static_cast<std::size_t>(writer.finish() - bytes.data()));
}

void decompress_depth(std::span<const std::uint8_t> bytes, Image<std::uint16_t>& depth) {
  NibbleReader reader(bytes);
  std::uint16_t* at = depth.data();
  std::uint16_t* const end = at + depth.size();
  const auto run = [&] {
    const std::uint32_t length = reader.number();
    if (length > static_cast<std::size_t>(end - at)) {
      throw Error(Error::input, "compressed depth has more pixels than its size says");
    }
    return length;
  };
  std::uint32_t previous = 0;
  while (at != end) {
    const std::uint32_t gap = run();
    at = std::fill_n(at, gap, std::uint16_t{0});
    const std::uint32_t measured = run();
    if (gap == 0 && measured == 0) throw Error(Error::input, "compressed depth has an empty run");
    for (std::uint16_t* const stop = at + measured; at != stop; ++at) {
      previous += from_zigzag(reader.number());
      *at = static_cast<std::uint16_t>(previous);
    }
  }
  if (!reader.is_at_end()) {
    throw Error(Error::input, "compressed depth goes on after its last pixel");
  }
}

}  // namespace diminish::ros
