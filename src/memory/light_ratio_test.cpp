#include "memory/light_ratio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "diminish/diminished_frame.h"

namespace diminish {
namespace {

/// Grey everywhere, and all of it in the mask: an RGB-D camera saw it under the objects' shadow,
/// which grows darker towards the right.
class LightRatioTest : public ::testing::Test {
 protected:
  static constexpr int width = 192;
  static constexpr int height = 128;
  static float shadow(int x) { return 0.9F - 0.3F * static_cast<float>(x) / width; }

  LightRatioTest() {
    drawn.region = TiledRegion(Rect{0, 0, width, height});
    drawn.color.resize(width, height, {0, 0, 0, 255});
    drawn.source.resize(width, height, provenance::first_rgbd);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto level = [&](float lit) { return static_cast<std::uint8_t>(lit * shadow(x)); };
        drawn.color(x, y) = {level(180), level(120), level(60), 255};
      }
    }
  }
  /// Pixels of these rows are witnessed; the others are brought to their light.
  void witness(int first_row, int last_row) {
    std::vector<LightRatio::Pair> pairs;
    for (int y = first_row; y < last_row; y += LightRatio::step) {
      for (int x = 0; x < width; x += LightRatio::step) {
        const Eigen::Array3f lit(180, 120, 60);
        pairs.push_back({x, y, lit * shadow(x), lit});
      }
    }
    ratio.begin({0, 0, width, height});
    ratio.add(pairs);
    ratio.solve();
    ratio.apply(mask, drawn);
  }

  Mask mask = Mask(width, height, 255);
  Reconstruction drawn;
  LightRatio ratio;
};

TEST_F(LightRatioTest, BringsWhatIsLiveToTheLightBeside) {
  const Reconstruction before = drawn;
  mask(100, 40) = 0;
  drawn.source(101, 40) = provenance::witnessed;
  drawn.source(102, 40) = 0;
  witness(0, 48);
  for (int x = 32; x < width - 32; ++x) {
    if (x >= 100 && x <= 102) {
      EXPECT_EQ(drawn.color(x, 40).b, before.color(x, 40).b);
      continue;
    }
    const Bgra& dark = before.color(x, 40);
    const Bgra& shown = drawn.color(x, 40);
    // Two thirds of the shadow at least.
    EXPECT_NEAR(shown.b, 180, (180 - dark.b) / 3 + 1) << x;
    EXPECT_NEAR(shown.g, 120, (120 - dark.g) / 3 + 1) << x;
    EXPECT_NEAR(shown.r, 60, (60 - dark.r) / 3 + 1) << x;
    EXPECT_EQ(drawn.color(x, 120).b, before.color(x, 120).b) << "too far away to tell";
  }
}

TEST_F(LightRatioTest, ChangesNothingWithoutWitnesses) {
  const Reconstruction before = drawn;
  witness(0, 0);
  EXPECT_EQ(drawn.color, before.color);
}

}  // namespace
}  // namespace diminish
