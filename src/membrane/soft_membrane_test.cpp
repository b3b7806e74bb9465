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

constexpr int step = SoftMembrane::step;

/// These differences, with noise, in a strip of 24 columns at the left; none in one of them.
void add_strip(SoftMembrane& membrane, const Eigen::Array3f& difference, float deviation = 1,
               int left_out = -1) {
  std::mt19937 random(2);
  std::normal_distribution<float> noise(0, deviation);
  for (int y = region.y; y < region.bottom(); y += step) {
    for (int x = region.x; x < region.x + 24; x += step) {
      const Eigen::Array3f noises{noise(random), noise(random), noise(random)};
      if (x - region.x != left_out) membrane.add(x, y, difference + noises);
    }
  }
}

TEST(SoftMembrane, FollowsDifferencesAndFadesAwayFromThem) {
  SoftMembrane membrane;
  membrane.begin(region);
  add_strip(membrane, {6, -3, 0});
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
    add_strip(*membrane, {6, -3, 0}, 1, 12);
  }
  for (int y = region.y; y < region.bottom(); y += step) {
    disturbed.add(region.x + 12, y, {-60, 0, 40});
  }
  plain.solve();
  disturbed.solve();
  EXPECT_EQ(row_of(plain, 100), row_of(disturbed, 100));
}

/// In the strip's middle, where the strip has these differences.
float correction_of(const Eigen::Array3f& difference, float deviation) {
  SoftMembrane membrane;
  membrane.begin(region);
  add_strip(membrane, difference, deviation);
  membrane.solve();
  return row_of(membrane, 150)[8];
}

TEST(SoftMembrane, FollowsLargeDifferencesWhereTheyAgree) {
  EXPECT_NEAR(correction_of({25, 28, 20}, 2), 25, 1.5);
  EXPECT_NEAR(correction_of({-25, -28, -20}, 2), -25, 1.5);
  // Edges that are out of line, and another surface.
  EXPECT_LT(correction_of({25, 28, 20}, 20), 4);
  EXPECT_EQ(correction_of({60, 60, 60}, 2), 0);
}

TEST(SoftMembrane, IsZeroWithoutDifferences) {
  SoftMembrane membrane;
  membrane.begin(region);
  membrane.solve();
  for (const float value : row_of(membrane, 20)) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace diminish
