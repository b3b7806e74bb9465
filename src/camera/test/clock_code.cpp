#include "camera/test/clock_code.h"

#include <algorithm>

namespace diminish {
namespace {

constexpr int bits = 40;

int square_size(ImageView<Bgr> picture) {
  return std::min({16, picture.width() / bits, picture.height()});
}

std::uint8_t checksum(std::uint32_t ticks) {
  std::uint32_t sum = 0x5a;  // so that black is no code
  for (int shift = 0; shift < 32; shift += 8) sum = sum * 31 + ((ticks >> shift) & 0xff);
  return static_cast<std::uint8_t>(sum ^ (sum >> 8));
}

}  // namespace

void draw_clock_code(std::uint32_t ticks, Image<Bgr>& picture) {
  const int size = square_size(picture);
  const std::uint64_t code = (static_cast<std::uint64_t>(checksum(ticks)) << 32) | ticks;
  for (int bit = 0; bit < bits; ++bit) {
    const std::uint8_t level = (code >> bit) & 1 ? 255 : 0;
    picture.fill(Rect{bit * size, 0, size, size}, Bgr{level, level, level});
  }
}

std::optional<std::uint32_t> read_clock_code(ImageView<Bgr> picture) {
  const int size = square_size(picture);
  if (size < 4) return std::nullopt;
  std::uint64_t code = 0;
  for (int bit = 0; bit < bits; ++bit) {
    int sum = 0;
    int count = 0;
    for (int y = size / 4; y < size - size / 4; ++y) {
      for (int x = size / 4; x < size - size / 4; ++x) {
        sum += picture(bit * size + x, y).g;
        ++count;
      }
    }
    if (sum > 127 * count) code |= std::uint64_t{1} << bit;
  }
  const auto ticks = static_cast<std::uint32_t>(code);
  if (checksum(ticks) != static_cast<std::uint8_t>(code >> 32)) return std::nullopt;
  return ticks;
}

}  // namespace diminish
