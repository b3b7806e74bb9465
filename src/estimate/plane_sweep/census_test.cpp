#include "estimate/plane_sweep/census.h"

#include <gtest/gtest.h>

#include <random>

#include "each_vector_target.h"

namespace diminish {
namespace {

/// Random brightness; a few pixels are unknown.
Image<std::uint8_t> picture(int width, int height) {
  Image<std::uint8_t> grey(width, height);
  std::mt19937 random(3);
  for (std::uint8_t& level : grey) {
    level = static_cast<std::uint8_t>(random() % 20 == 0 ? 0 : 1 + random() % 120);
  }
  return grey;
}

std::uint32_t code_of(const Image<std::uint8_t>& grey, int x, int y) {
  const Rect inner = {2, 2, grey.width() - 4, grey.height() - 4};
  if (!inner.contains(x, y) || grey(x, y) == 0) return unknown_census;
  std::uint32_t code = 0;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      if (dx != 0 || dy != 0) code = 2 * code + (grey(x + dx, y + dy) < grey(x, y) ? 1 : 0);
    }
  }
  return code;
}

TEST(Census, ComparesEachPixelWithThoseAroundIt) {
  for (const auto& size : {std::pair{61, 37}, {5, 5}, {4, 9}, {1, 1}, {130, 70}}) {
    const Image<std::uint8_t> grey = picture(size.first, size.second);
    testing::on_each_vector_target([&] {
      Image<std::uint32_t> codes(grey.width(), grey.height(), 7);
      census(grey, grey.bounds(), codes);
      for (int y = 0; y < grey.height(); ++y) {
        for (int x = 0; x < grey.width(); ++x)
          ASSERT_EQ(codes(x, y), code_of(grey, x, y)) << x << ' ' << y;
      }
    });
  }
}

TEST(Census, LeavesTheRestAlone) {
  const Image<std::uint8_t> grey = picture(40, 30);
  Image<std::uint32_t> codes(40, 30, 7);
  const Rect part = {10, 8, 13, 5};
  census(grey, part, codes);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      EXPECT_EQ(codes(x, y), part.contains(x, y) ? code_of(grey, x, y) : 7U);
    }
  }
}

TEST(Census, DoesNotDependOnBrightnessAndContrast) {
  const Image<std::uint8_t> grey = picture(40, 30);
  Image<std::uint8_t> brighter = grey;
  for (std::uint8_t& level : brighter) {
    if (level != 0) level = static_cast<std::uint8_t>(2 * level + 14);
  }
  Image<std::uint32_t> codes(40, 30);
  Image<std::uint32_t> codes_of_brighter(40, 30);
  census(grey, grey.bounds(), codes);
  census(brighter, grey.bounds(), codes_of_brighter);
  EXPECT_EQ(codes, codes_of_brighter);
}

}  // namespace
}  // namespace diminish
