#include "gl/mask_bits.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace diminish::gl {
namespace {

/// Eight pixels for each eight bits.
std::array<std::array<std::uint8_t, 8>, 256> make_pixels() {
  std::array<std::array<std::uint8_t, 8>, 256> all{};
  for (std::size_t bits = 0; bits < all.size(); ++bits) {
    for (std::size_t i = 0; i < 8; ++i) all[bits][i] = (bits >> i & 1U) != 0 ? 255 : 0;
  }
  return all;
}

}  // namespace

void pack_bits(const Mask& mask, std::uint32_t* words) {
  for (int y = 0; y < mask.height(); ++y) {
    const std::uint8_t* const row = mask.row(y);
    for (int x = 0; x < mask.width(); x += 32) {
      const int count = std::min(32, mask.width() - x);
      std::uint32_t word = 0;
      for (int i = 0; i < count; ++i) {
        word |= (row[x + i] != 0 ? 1U : 0U) << static_cast<unsigned>(i);
      }
      *words++ = word;
    }
  }
}

void unpack_bits(const std::uint32_t* words, Mask& mask) {
  static const auto pixels = make_pixels();
  for (int y = 0; y < mask.height(); ++y) {
    std::uint8_t* const row = mask.row(y);
    for (int x = 0; x < mask.width(); x += 32, ++words) {
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
