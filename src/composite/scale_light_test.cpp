#include "composite/scale_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace diminish {
namespace {

/// The rule for one level at column x.
std::uint8_t scaled(const LightGains& gains, int x, int c, std::uint8_t label, std::uint8_t level) {
  const auto last = static_cast<int>(gains.by_cell.size()) - 1;
  // Sixteenths of a cell from the first one's middle.
  const int at = std::max(2 * x - 7, 0);
  const int left = gains.by_cell[static_cast<std::size_t>(std::min(at / 16, last))][c];
  const int right = gains.by_cell[static_cast<std::size_t>(std::min(at / 16 + 1, last))][c];
  const int between = ((16 - at % 16) * left + at % 16 * right) / 16;
  const int gain = label == gains.label ? between : LightGains::one;
  const int lost = (gain * (255 - level) + LightGains::one / 2) / LightGains::one;
  return static_cast<std::uint8_t>(255 - std::min<int>(lost, gains.most_dark));
}

TEST(ScaleLight, IsTheRuleForEachPixel) {
  constexpr int label = 3;
  std::mt19937 random(5);
  const auto level = [&] { return static_cast<std::uint8_t>(random() % 256); };
  int changed = 0;
  for (int count = 1; count < 70; ++count) {
    std::vector<Eigen::Array4i> by_cell(static_cast<std::size_t>(std::max(1, count / 8)));
    for (Eigen::Array4i& gain : by_cell) {
      for (int c = 0; c < 3; ++c) gain[c] = static_cast<int>(random() % 161);
    }
    const LightGains gains{by_cell, label, 229};
    std::vector<std::uint8_t> labels;
    std::vector<Bgr> light;
    for (int x = 0; x < count; ++x) {
      labels.push_back(random() % 3 == 0 ? label + 1 : label);
      const bool is_lit = x / 16 % 2 == 1;
      light.push_back(is_lit ? Bgr{255, 255, 255} : Bgr{level(), level(), level()});
    }
    light.push_back({1, 2, 3});
    const std::vector<Bgr> before = light;
    scale_light(gains, labels.data(), count, light.data());
    for (int x = 0; x < count; ++x) {
      const auto i = static_cast<std::size_t>(x);
      const Bgr expected{scaled(gains, x, 0, labels[i], before[i].b),
                         scaled(gains, x, 1, labels[i], before[i].g),
                         scaled(gains, x, 2, labels[i], before[i].r)};
      ASSERT_EQ(light[i], expected) << x << " of " << count;
      changed += light[i] == before[i] ? 0 : 1;
    }
    EXPECT_EQ(light.back(), before.back()) << count;
  }
  EXPECT_GT(changed, 500);
}

}  // namespace
}  // namespace diminish
