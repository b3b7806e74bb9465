#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "diminish/image.h"
#include "diminish/membrane.h"

namespace diminish {
namespace {

/// Pictures down to a pixel, and sets of pixels as no one would make them.
class RandomSets : public ::testing::TestWithParam<unsigned> {
 protected:
  int below(int end) { return std::uniform_int_distribution(0, end - 1)(random_); }

  void begin() {
    constexpr int small = 5;
    constexpr int large = 90;
    const int most = below(2) == 0 ? small : large;
    picture.resize(1 + below(most), 1 + below(most));
    mask.resize(picture.width(), picture.height());
    const bool has_noise = below(2) == 0;
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        const auto level = [&] {
          return static_cast<std::uint8_t>(has_noise ? below(256) : 3 * x);
        };
        picture(x, y) = {level(), level(), level()};
      }
    }
    const int share = below(12);
    for (std::uint8_t& pixel : mask) pixel = below(12) < share ? 255 : 0;
    if (below(2) == 0) {
      const int x = below(mask.width());
      const int y = below(mask.height());
      mask.fill({x, y, 1 + below(mask.width() - x), 1 + below(mask.height() - y)}, 255);
    }
  }

  /// The smallest and the largest value of a channel beside the set's part that holds a pixel.
  /// Marks the part in `done`.
  std::array<int, 2> bounds_of_part(int x0, int y0, int channel, Mask& done,
                                    std::vector<std::array<int, 2>>& part) const {
    std::array<int, 2> bounds = {255, 0};
    part = {{x0, y0}};
    done(x0, y0) = 1;
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (const auto& [dx, dy] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int x = part[i][0] + dx;
        const int y = part[i][1] + dy;
        if (!mask.bounds().contains(x, y)) continue;
        if (mask(x, y) == 0) {
          const int value = value_of(picture(x, y), channel);
          bounds = {std::min(bounds[0], value), std::max(bounds[1], value)};
        } else if (done(x, y) == 0) {
          done(x, y) = 1;
          part.push_back({x, y});
        }
      }
    }
    return bounds;
  }
  static int value_of(const Bgr& pixel, int channel) {
    return channel == 0 ? pixel.b : channel == 1 ? pixel.g : pixel.r;
  }

  Image<Bgr> picture;
  Mask mask;

 private:
  std::mt19937 random_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Seeds, RandomSets, ::testing::Range(0U, 8U));

// A harmonic function has no maximum and no minimum inside.
TEST_P(RandomSets, FillingsAreBoundedByWhatIsBeside) {
  Membrane membrane;
  for (int trial = 0; trial < 100; ++trial) {
    begin();
    SCOPED_TRACE(::testing::Message() << trial << ": " << mask.width() << "x" << mask.height());
    Image<Bgr> filled = picture;
    const Membrane::View view = {reinterpret_cast<std::uint8_t*>(filled.data()), filled.width(),
                                 filled.height(), 3 * filled.width(), 3};
    const Membrane::ConstView set = {mask.data(), mask.width(), mask.height(), mask.width(), 1};
    const bool is_filled = membrane.fill(set, view);
    const auto known = std::count(mask.begin(), mask.end(), 0);
    EXPECT_TRUE(known > 0 || !is_filled);
    for (int channel = 0; channel < 3; ++channel) {
      Mask done(mask.width(), mask.height(), 0);
      std::vector<std::array<int, 2>> part;
      for (int y = 0; y < mask.height(); ++y) {
        for (int x = 0; x < mask.width(); ++x) {
          if (mask(x, y) == 0 || !is_filled) {
            ASSERT_EQ(filled(x, y), picture(x, y));
            continue;
          }
          if (done(x, y) != 0) continue;
          const auto [least, most] = bounds_of_part(x, y, channel, done, part);
          for (const auto& [px, py] : part) {
            const int value = value_of(filled(px, py), channel);
            ASSERT_GE(value, least - 1) << px << " " << py;  // rounded
            ASSERT_LE(value, most + 1) << px << " " << py;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace diminish
