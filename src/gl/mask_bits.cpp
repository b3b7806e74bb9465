#include "gl/mask_bits.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace diminish::gl {
namespace {

/// Eight pixels for every eight bits.
std::array<std::array<std::uint8_t, 8>, 256> make_pixels() {
  std::array<std::array<std::uint8_t, 8>, 256> all{};
  for (std::size_t bits = 0; bits < all.size(); ++bits) {
    for (std::size_t i = 0; i < 8; ++i) all[bits][i] = (bits >> i & 1U) != 0 ? 255 : 0;
  }
  return all;
}

}  // namespace

BitWindow::BitWindow(const Rect& part) {
  if (part.empty()) return;
  first_word = part.x / 32;
  first_row = part.y;
  words = (part.right() + 31) / 32 - first_word;
  rows = part.height;
}

void pack_bits(const Mask& mask, const BitWindow& window, std::uint32_t* words) {
  for (int y = window.first_row; y < window.first_row + window.rows; ++y) {
    const std::uint8_t* const row = mask.row(y);
    for (int word = window.first_word; word < window.first_word + window.words; ++word) {
      const int x = 32 * word;
      const int count = std::min(32, mask.width() - x);
      std::uint32_t bits = 0;
      for (int i = 0; i < count; ++i) {
        bits |= (row[x + i] != 0 ? 1U : 0U) << static_cast<unsigned>(i);
      }
      *words++ = bits;
    }
  }
}

void unpack_bits(const std::uint32_t* words, const BitWindow& window, Mask& mask) {
  static const auto pixels = make_pixels();
  for (int y = window.first_row; y < window.first_row + window.rows; ++y) {
    std::uint8_t* const row = mask.row(y);
    for (int word = window.first_word; word < window.first_word + window.words; ++word, ++words) {
      const int x = 32 * word;
      const int count = std::min(32, mask.width() - x);
      for (int i = 0; i < count; i += 8) {
        const auto bits = static_cast<std::uint8_t>(*words >> static_cast<unsigned>(i));
        std::memcpy(row + x + i, pixels[bits].data(),
                    static_cast<std::size_t>(std::min(8, count - i)));
      }
    }
  }
}

}  // namespace diminish::gl
