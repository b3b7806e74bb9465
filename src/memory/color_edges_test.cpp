#include "memory/color_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace diminish {
namespace {

/// One sample after the other.
SideVotes plain_votes(const VoteSamples& samples, const Voter& voter) {
  SideVotes votes{};
  for (int y = 0; y < VoteSamples::side; ++y) {
    for (int x = 0; x < VoteSamples::side; ++x) {
      const VoteSamples own = samples.from(y * samples.pitch + x);
      const float inverse_z = *own.inverse_z;
      if (inverse_z < 0.9F * voter.far || inverse_z > 1.1F * voter.near) continue;
      const float blue = *own.blue - voter.blue;
      const float green = *own.green - voter.green;
      const float red = *own.red - voter.red;
      const float likeness = 1 / (1 + (blue * blue + green * green + red * red) / 300);
      const int side = inverse_z > (voter.near + voter.far) / 2 ? 1 : 0;
      votes.weight[side] += likeness * likeness;
      votes.inverse_z[side] += likeness * likeness * inverse_z;
    }
  }
  return votes;
}

TEST(ColorVotes, AreThoseOfAllSamples) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> level(0, 255);
  std::uniform_real_distribution<float> depth(0.3F, 1.2F);
  constexpr int pitch = 11;
  std::vector<float> inverse_z(pitch * VoteSamples::side);
  std::vector<float> blue(inverse_z.size());
  std::vector<float> green(inverse_z.size());
  std::vector<float> red(inverse_z.size());
  for (int repeat = 0; repeat < 100; ++repeat) {
    for (std::size_t i = 0; i < inverse_z.size(); ++i) {
      inverse_z[i] = random() % 3 == 0 ? 0 : depth(random);
      blue[i] = level(random);
      green[i] = level(random);
      red[i] = level(random);
    }
    const VoteSamples samples{inverse_z.data(), blue.data(), green.data(), red.data(), pitch};
    const Voter voter{level(random), level(random), level(random), 0.5F, 1};
    const SideVotes votes = count_votes(samples, voter);
    const SideVotes expected = plain_votes(samples, voter);
    for (int side = 0; side < 2; ++side) {
      EXPECT_NEAR(votes.weight[side], expected.weight[side], 1e-4F);
      EXPECT_NEAR(votes.inverse_z[side], expected.inverse_z[side], 1e-4F);
    }
  }
}

/// A red thing 1 m away, in front of a blue wall 2 m away, of which depth was measured some places
/// too wide or too narrow.
class WrongEdge : public ::testing::TestWithParam<int> {};

TEST_P(WrongEdge, MovesToThePicture) {
  constexpr int width = 61;
  constexpr int height = 47;
  constexpr int edge = 30;
  const int measured_edge = edge + GetParam();
  Image<Bgr> colors(width, height);
  Image<float> inverse_depth(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      colors(x, y) = x < edge ? Bgr{20, 30, 200} : Bgr{200, 60, 40};
      inverse_depth(x, y) = x < measured_edge ? 1 : 0.5F;
    }
  }
  ColorEdges().align(colors, inverse_depth);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      ASSERT_EQ(inverse_depth(x, y), x < edge ? 1 : 0.5F) << x << ' ' << y;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(ByPlaces, WrongEdge, ::testing::Values(-3, -2, -1, 0, 1, 2, 3));

TEST(ColorEdges, LeaveAnEdgeWhereColorsAreAlike) {
  Image<Bgr> colors(60, 40, Bgr{90, 90, 90});
  Image<float> inverse_depth(60, 40, 0.5F);
  inverse_depth.fill({0, 0, 27, 40}, 1);
  const Image<float> before = inverse_depth;
  ColorEdges().align(colors, inverse_depth);
  EXPECT_EQ(inverse_depth, before);
}

}  // namespace
}  // namespace diminish
