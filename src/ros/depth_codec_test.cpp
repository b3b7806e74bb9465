#include "ros/depth_codec.h"

#include <gmock/gmock.h>

#include <random>

#include "expect_error.h"

namespace diminish::ros {
namespace {

using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;
using Depth = Image<std::uint16_t>;

/// The format as the paper describes it, as a list of nibbles.
class PlainEncoder {
 public:
  explicit PlainEncoder(const Depth& depth) {
    std::size_t i = 0;
    int last = 0;
    while (i < depth.size()) {
      const auto run = [&](bool is_gap) {
        std::size_t length = 0;
        while (i + length < depth.size() && (depth.data()[i + length] == 0) == is_gap) ++length;
        number(length);
        return length;
      };
      i += run(true);
      const std::size_t end = i + run(false);
      for (; i < end; ++i) {
        const int difference = depth.data()[i] - last;
        last = depth.data()[i];
        number(difference < 0 ? -2UL * difference - 1 : 2UL * difference);
      }
    }
    while (nibbles_.size() % 8 != 0) nibbles_.push_back(0);
  }

  Bytes bytes() const {
    Bytes result;
    for (std::size_t word = 0; word < nibbles_.size(); word += 8) {
      for (std::size_t k = 4; k-- > 0;) {
        result.push_back(
            static_cast<std::uint8_t>(nibbles_[word + 2 * k] << 4 | nibbles_[word + 2 * k + 1]));
      }
    }
    return result;
  }

 private:
  void number(std::size_t value) {
    for (; value > 7; value /= 8) nibbles_.push_back(8 + value % 8);
    nibbles_.push_back(value);
  }

  std::vector<std::size_t> nibbles_;
};

Depth random_depth(int width, int height, double gaps, int step, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution turns(gaps);
  std::uniform_int_distribution<int> change(-step, step);
  Depth depth(width, height);
  bool is_gap = false;
  int value = 1000;
  for (std::uint16_t& pixel : depth) {
    if (turns(random)) is_gap = !is_gap;
    value = std::clamp(value + change(random), 1, 65535);
    pixel = is_gap ? std::uint16_t{0} : static_cast<std::uint16_t>(value);
  }
  return depth;
}

std::vector<Depth> awkward_images() {
  std::vector<Depth> images = {Depth(7, 5), Depth(1, 1), Depth(1, 1, 65535), Depth(9, 3, 1)};
  unsigned seed = 1;
  for (const auto& [width, height] : {std::pair{13, 1}, {1, 13}, {640, 48}, {257, 31}}) {
    for (const double gaps : {0., .01, .3, 1.}) {
      for (const int step : {0, 2, 300, 65535}) {
        images.push_back(random_depth(width, height, gaps, step, seed++));
      }
    }
  }
  return images;
}

TEST(DepthCodec, WritesThePapersFormat) {
  for (const Depth& depth : awkward_images()) {
    Bytes bytes = {42};
    compress_depth(depth, bytes);
    EXPECT_EQ(bytes[0], 42);
    bytes.erase(bytes.begin());
    EXPECT_THAT(bytes, ElementsAreArray(PlainEncoder(depth).bytes()));
  }
}

TEST(DepthCodec, LosesNothing) {
  for (const Depth& depth : awkward_images()) {
    Bytes bytes;
    compress_depth(depth, bytes);
    Depth back(depth.width(), depth.height(), 77);
    decompress_depth(bytes, back);
    EXPECT_EQ(back, depth);
  }
}

TEST(DepthCodec, RowsMayHaveGaps) {
  const Depth whole = random_depth(32, 8, .05, 20, 3);
  const ImageView<std::uint16_t> left(whole.data(), 20, 8, 32 * sizeof(std::uint16_t));
  Depth expected;
  copy(left, expected);
  Bytes bytes;
  compress_depth(left, bytes);
  Depth back(20, 8);
  decompress_depth(bytes, back);
  EXPECT_EQ(back, expected);
}

TEST(DepthCodec, WhatIsNotExactlyTheImageIsRefused) {
  const Depth depth = random_depth(40, 10, .02, 300, 9);
  Bytes bytes;
  compress_depth(depth, bytes);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    Depth back(40, 10);
    const auto cut = std::span(bytes).first(length);
    EXPECT_THAT(error_of([&] { decompress_depth(cut, back); }), HasSubstr("ends too early"));
  }
  Depth smaller(40, 9), larger(40, 11);
  EXPECT_THAT(error_of([&] { decompress_depth(bytes, smaller); }), HasSubstr("more pixels"));
  EXPECT_THAT(error_of([&] { decompress_depth(bytes, larger); }), HasSubstr("compressed depth"));
  bytes.insert(bytes.end(), 4, 0);
  Depth back(40, 10);
  EXPECT_THAT(error_of([&] { decompress_depth(bytes, back); }), HasSubstr("goes on after"));
  EXPECT_THAT(error_of([&] { decompress_depth(Bytes(64, 0), back); }), HasSubstr("empty run"));
  EXPECT_THAT(error_of([&] { decompress_depth(Bytes(64, 0xff), back); }), HasSubstr("32 bits"));
}

}  // namespace
}  // namespace diminish::ros
