#include "core/runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace diminish {
namespace {

using FirstLast = std::pair<int, int>;

/// Bytes in stretches of up to `longest`, of few values.
std::vector<std::uint8_t> stretches(std::mt19937& random, std::size_t size, unsigned longest) {
  constexpr std::uint8_t values[] = {0, 0, 1, 255, 0x80};
  std::vector<std::uint8_t> bytes;
  while (bytes.size() < size)
    bytes.insert(bytes.end(), 1 + random() % longest, values[random() % 5]);
  bytes.resize(size);
  return bytes;
}

/// Pixel by pixel.
template <class IsIn>
std::vector<FirstLast> plain_runs(int begin, int end, const IsIn& is_in) {
  std::vector<FirstLast> runs;
  for (int x = begin; x < end; ++x) {
    if (!is_in(x)) continue;
    if (runs.empty() || runs.back().second != x) runs.emplace_back(x, x);
    runs.back().second = x + 1;
  }
  return runs;
}

TEST(Runs, OfBytesAreThoseFoundByteByByte) {
  std::mt19937 random(4);
  for (const std::size_t size : {0, 1, 7, 8, 9, 40, 63, 200, 333}) {
    for (const unsigned longest : {1U, 4U, 90U}) {
      const std::vector<std::uint8_t> bytes = stretches(random, size, longest);
      const auto count = static_cast<int>(size);
      for (int begin = 0; begin <= count; begin += 5) {
        for (const Pixels pixels : {Pixels::set, Pixels::clear}) {
          std::vector<FirstLast> runs;
          for_each_run(bytes.data(), begin, count, pixels,
                       [&](int first, int last) { runs.emplace_back(first, last); });
          EXPECT_EQ(runs, plain_runs(begin, count, [&](int x) {
                      return (bytes[static_cast<std::size_t>(x)] != 0) == (pixels == Pixels::set);
                    }));
        }
        for (const auto value : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{255}}) {
          const auto from = bytes.begin() + begin;
          std::vector<FirstLast> runs;
          for_each_run(bytes.data(), begin, count, value,
                       [&](int first, int last) { runs.emplace_back(first, last); });
          EXPECT_EQ(runs, plain_runs(begin, count, [&](int x) {
                      return bytes[static_cast<std::size_t>(x)] == value;
                    }));
          EXPECT_EQ(find_equal(bytes.data(), begin, count, value),
                    std::find(from, bytes.end(), value) - bytes.begin());
          EXPECT_EQ(find_other(bytes.data(), begin, count, value),
                    std::find_if(from, bytes.end(), [&](auto byte) { return byte != value; }) -
                        bytes.begin());
        }
      }
      std::vector<int> set, expected;
      for_each_set(bytes.data(), count, [&](int x) { set.push_back(x); });
      for (int x = 0; x < count; ++x) {
        if (bytes[static_cast<std::size_t>(x)] != 0) expected.push_back(x);
      }
      EXPECT_EQ(set, expected);
    }
  }
}

TEST(Runs, OfBitsAreThoseFoundBitByBit) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<std::uint32_t> words(static_cast<std::size_t>(trial % 4));
    for (std::uint32_t& word : words) {
      // Whole words and parts of them, so that runs cross their borders.
      const std::uint32_t values[] = {0, ~0U, ~0U << random() % 32, ~0U >> random() % 32,
                                      static_cast<std::uint32_t>(random())};
      word = values[random() % 5];
    }
    const auto is_set = [&](int x) {
      return (words[static_cast<std::size_t>(x / 32)] >> x % 32 & 1U) != 0;
    };
    const auto count = static_cast<int>(words.size());
    std::vector<FirstLast> runs;
    for_each_run(words.data(), count, [&](int first, int last) { runs.emplace_back(first, last); });
    EXPECT_EQ(runs, plain_runs(0, 32 * count, is_set));
    for (int word = 0; word < count; ++word) {
      int next = 0;
      for_each_bit(words[static_cast<std::size_t>(word)], [&](int bit) {
        for (; next < bit; ++next) EXPECT_FALSE(is_set(32 * word + next));
        EXPECT_TRUE(is_set(32 * word + next++));
      });
      for (; next < 32; ++next) EXPECT_FALSE(is_set(32 * word + next));
    }
  }
}

TEST(Runs, AllEqualLooksAtEachByte) {
  std::vector<std::uint8_t> bytes(50, 7);
  EXPECT_TRUE(all_equal<48>(bytes.data() + 1, 7));
  EXPECT_FALSE(all_equal<48>(bytes.data() + 1, 6));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = 71;
    EXPECT_EQ(all_equal<48>(bytes.data() + 1, 7), i == 0 || i == 49) << i;
    EXPECT_EQ(all_equal<4>(bytes.data() + 1, 7), i == 0 || i > 4) << i;
    bytes[i] = 7;
  }
}

TEST(Runs, FindWithoutLooksAtEachByte) {
  std::mt19937 random(6);
  for (const unsigned longest : {1U, 4U, 90U}) {
    const std::vector<std::uint8_t> bytes = stretches(random, 200, longest);
    for (int begin = 0; begin < 200; begin += 3) {
      for (int end = begin; end <= 200; end += 7) {
        for (const std::uint8_t bit : {std::uint8_t{0x80}, std::uint8_t{1}}) {
          const auto found = std::find_if(bytes.begin() + begin, bytes.begin() + end,
                                          [&](std::uint8_t byte) { return (byte & bit) == 0; });
          ASSERT_EQ(find_without(bytes.data(), begin, end, bit), found - bytes.begin());
        }
      }
    }
  }
}

TEST(Runs, IsAnyBelowLooksAtEachByte) {
  for (const int least : {1, 39, 128}) {
    std::vector<std::uint8_t> bytes(24, 255);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      for (int level = 0; level < 256; ++level) {
        bytes[i] = static_cast<std::uint8_t>(level);
        ASSERT_EQ(is_any_below<24>(bytes.data(), least), level < least) << i << ' ' << level;
      }
      bytes[i] = static_cast<std::uint8_t>(i % 2 == 0 ? least : 255);
    }
  }
}

}  // namespace
}  // namespace diminish
