#include "composite/mix_inventions.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "diminish/diminished_frame.h"

namespace diminish {
namespace {

/// The rule, pixel by pixel.
Bgr mixed(const EarlierInventions& earlier, const Eigen::Vector2f& at, int share, const Bgr& now) {
  const auto x = static_cast<int>(std::lrint(at.x() * 256));
  const auto y = static_cast<int>(std::lrint(at.y() * 256));
  const int left = x >> 8;
  const int top = y >> 8;
  for (const int column : {left, left + 1}) {
    for (const int row : {top, top + 1}) {
      if (!earlier.part.contains(column, row) || earlier.picture(column, row).a == 0) return now;
    }
  }
  const int right = x - 256 * left;
  const int down = y - 256 * top;
  const auto mix = [&](std::uint8_t Bgra::*channel, int own) {
    const auto level = [&](int dx, int dy) {
      return earlier.picture(left + dx, top + dy).*channel;
    };
    const int above = (256 - right) * level(0, 0) + right * level(1, 0);
    const int below = (256 - right) * level(0, 1) + right * level(1, 1);
    const int before = ((256 - down) * above + down * below) / 256;
    return static_cast<std::uint8_t>((share * before + (256 - share) * 256 * own + 32768) / 65536);
  };
  return {mix(&Bgra::b, now.b), mix(&Bgra::g, now.g), mix(&Bgra::r, now.r)};
}

class MixInventions : public ::testing::Test {
 protected:
  std::uint8_t byte() { return static_cast<std::uint8_t>(random() % 256); }
  float uniform(float least, float most) {
    return std::uniform_real_distribution<float>(least, most)(random);
  }
  std::mt19937 random{3};
};

TEST_F(MixInventions, KeepsColoursAndWhatWasInvented) {
  for (const int count : {0, 1, 3, 67}) {
    std::vector<Bgr> colors;
    std::vector<std::uint8_t> origins;
    for (int i = 0; i < count; ++i) {
      colors.push_back({byte(), byte(), byte()});
      const std::uint8_t kinds[] = {provenance::inpainted, provenance::estimated,
                                    provenance::unknown};
      origins.push_back(kinds[random() % 3]);
    }
    std::vector<Bgra> kept(colors.size() + 1, Bgra{1, 2, 3, 4});
    keep_inventions(colors.data(), origins.data(), count, kept.data());
    for (std::size_t i = 0; i < colors.size(); ++i) {
      const bool is_invented = origins[i] != provenance::unknown;
      const Bgra expected{colors[i].b, colors[i].g, colors[i].r,
                          static_cast<std::uint8_t>(is_invented ? 255 : 0)};
      EXPECT_EQ(kept[i], expected) << i << " of " << count;
    }
    EXPECT_EQ(kept.back(), (Bgra{1, 2, 3, 4})) << count;
  }
}

TEST_F(MixInventions, IsTheRuleForEachPixel) {
  Image<Bgra> picture(40, 30);
  for (Bgra& pixel : picture) {
    pixel = {byte(), byte(), byte(), static_cast<std::uint8_t>(random() % 16 == 0 ? 0 : 255)};
  }
  int mixed_pixels = 0;
  int others = 0;
  for (int round = 0; round < 500; ++round) {
    const Rect part =
        round % 4 == 0 ? picture.bounds() : Rect{7, 5, 1 + round % 30, 1 + round % 20};
    const EarlierInventions earlier{picture, part};
    const InventionRun run{{uniform(-20, 50), uniform(-10, 40)},
                           {uniform(-2, 2), uniform(-1, 1)},
                           1 + round % InventionRun::most};
    const int share = round % 257;
    std::array<Bgr, InventionRun::most + 1> colors;
    for (Bgr& color : colors) color = {byte(), byte(), byte()};
    const auto before = colors;
    mix_inventions(earlier, run, share, colors.data());
    for (int i = 0; i <= InventionRun::most; ++i) {
      const Bgr& own = before[static_cast<std::size_t>(i)];
      Bgr expected = own;
      if (i < run.count) {
        expected = mixed(earlier, run.first + static_cast<float>(i) * run.step, share, own);
      }
      ++(expected == own ? others : mixed_pixels);
      ASSERT_EQ(colors[static_cast<std::size_t>(i)], expected) << round << ", pixel " << i;
    }
  }
  EXPECT_GT(mixed_pixels, 300);
  EXPECT_GT(others, 300);
}

}  // namespace
}  // namespace diminish
