#include "memory/surroundings.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

namespace diminish {
namespace {

constexpr Rect bounds{0, 0, 37, 22};

/// One pixel after the other, over what lies around it.
template <class Combine>
std::uint8_t around(const Padded<std::uint8_t>& image, int x, int y, int channel, int reach,
                    std::uint8_t start, const Combine& combine) {
  std::uint8_t result = start;
  for (int row = y - reach; row <= y + reach; ++row) {
    for (int column = x - reach; column <= x + reach; ++column) {
      const bool is_inside = bounds.contains(column, row);
      const std::uint8_t value = is_inside ? image.at(column, row)[channel] : std::uint8_t{7};
      result = combine(result, value);
    }
  }
  return result;
}

TEST(Surroundings, AreCombined) {
  constexpr int channels = 3;
  Padded<std::uint8_t> image;
  Padded<std::uint8_t> across;
  Padded<std::uint8_t> result;
  for (Padded<std::uint8_t>* each : {&image, &across, &result}) each->resize(bounds, channels, 7);
  std::mt19937 random(3);
  for (int y = 0; y < bounds.height; ++y) {
    for (int i = 0; i < bounds.width * channels; ++i) {
      image.at(0, y)[i] = static_cast<std::uint8_t>(random());
    }
  }
  const auto least = [](std::uint8_t a, std::uint8_t b) { return std::min(a, b); };
  const auto greatest = [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); };
  const auto sum = [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a + b); };
  const auto expect = [&](const Rect& part, int reach, std::uint8_t start, const auto& combine) {
    combine_around(image, part, reach, combine, across, result);
    for (int y = part.y; y < part.bottom(); ++y) {
      for (int x = part.x; x < part.right(); ++x) {
        for (int c = 0; c < channels; ++c) {
          ASSERT_EQ(result.at(x, y)[c], around(image, x, y, c, reach, start, combine))
              << x << ", " << y << ", reach " << reach;
        }
      }
    }
  };
  for (const Rect& part : {bounds, Rect{4, 3, 20, 11}, Rect{0, 21, 37, 1}}) {
    for (const int reach : {1, 2, 3}) {
      expect(part, reach, 255, least);
      expect(part, reach, 0, greatest);
      expect(part, reach, 0, sum);
    }
  }
}

}  // namespace
}  // namespace diminish
