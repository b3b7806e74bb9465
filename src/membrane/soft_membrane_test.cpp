#include "membrane/soft_membrane.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace diminish {
namespace {

const Rect region{40, 20, 400, 300};

std::vector<float> row_of(const SoftMembrane& membrane, int y) {
  std::vector<SoftMembrane::Node> nodes;
  membrane.row(y, nodes);
  constexpr int cell = SoftMembrane::cell;
  std::vector<float> correction;
  for (int channel = 0; channel < 3; ++channel) {
    for (int x = 0; x < region.width; ++x) {
      const auto i = static_cast<std::size_t>(x / cell);
      correction.push_back(
          std::lerp(nodes[i][channel], nodes[i + 1][channel], static_cast<float>(x % cell) / cell));
    }
  }
  return correction;
}

/// Differences of 6 levels, with noise, in a strip at the left.
void add_strip(SoftMembrane& membrane) {
  std::mt19937 random(2);
  std::normal_distribution<float> noise(0, 1);
  constexpr int step = SoftMembrane::step;
  for (int y = region.y; y < region.bottom(); y += step) {
    for (int x = region.x; x < region.x + 24; x += step) {
      membrane.add(x, y, {6 + noise(random), -3 + noise(random), noise(random)});
    }
  }
}

TEST(SoftMembrane, FollowsDifferencesAndFadesAwayFromThem) {
  SoftMembrane membrane;
  membrane.begin(region);
  add_strip(membrane);
  membrane.solve();
  const std::vector<float> row = row_of(membrane, 150);
  EXPECT_NEAR(row[4], 6, 0.7);
  EXPECT_NEAR(row[400 + 4], -3, 0.7);
  EXPECT_NEAR(row[800 + 4], 0, 0.7);
  for (int x = 40; x < 390; ++x) EXPECT_LE(row[x + 8], row[x] + 0.2F) << x;
  // One dimension: m'' = fading m, in cells.
  const double per_cell = std::exp(-std::acosh(1 + 0.2 / 2));
  EXPECT_NEAR(row[24 + 5 * 16] / row[24 + 16], std::pow(per_cell, 4), 0.08);
  EXPECT_LT(std::abs(row[390]), 0.1);
}

TEST(SoftMembrane, OutliersLeaveNoTrace) {
  SoftMembrane plain;
  SoftMembrane disturbed;
  for (SoftMembrane* membrane : {&plain, &disturbed}) {
    membrane->begin(region);
    add_strip(*membrane);
  }
  for (int y = region.y; y < region.bottom(); ++y) disturbed.add(region.x + 10, y, {-60, 0, 40});
  plain.solve();
  disturbed.solve();
  EXPECT_EQ(row_of(plain, 100), row_of(disturbed, 100));
}

TEST(SoftMembrane, IsZeroWithoutDifferences) {
  SoftMembrane membrane;
  membrane.begin(region);
  membrane.solve();
  for (const float value : row_of(membrane, 20)) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace diminish
