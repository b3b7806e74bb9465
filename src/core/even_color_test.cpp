#include "core/even_color.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <random>

namespace diminish {
namespace {

// Up to the image's last pixel, on every instruction set, to the bit.
TEST(EvenColor, IsThePlainVersions) {
  std::mt19937 random(9);
  const auto level = [&](int from, unsigned range) {
    return static_cast<std::uint8_t>(from + static_cast<int>(random() % range));
  };
  for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & -rest);
    int even = 0;
    for (int i = 0; i < 500; ++i) {
      Image<Bgr> image(5, 5);
      const unsigned range = 22 + random() % 8;
      for (Bgr& color : image) {
        color = {level(0, range), level(100, range), level(255 - 29, range)};
      }
      const EvenColor expected = plain::even_color(image, 2, 2);
      const EvenColor color = even_color(image, 2, 2);
      for (int c = 0; c < 3; ++c) ASSERT_EQ(color.channels[c], expected.channels[c]);
      ASSERT_EQ(color.even, expected.even);
      even += color.even ? 1 : 0;
    }
    EXPECT_GT(even, 50);
    EXPECT_LT(even, 450);
    hwy::SetSupportedTargetsForTest(0);
  }
}

}  // namespace
}  // namespace diminish
