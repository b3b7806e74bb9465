#include "setup/check/clock_offset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace diminish {
namespace {

/// A marker that is waved, every 1/30 s for two seconds by a clock that shows `offset_s` more than
/// the right one.
std::vector<TimedPoint> waved(double offset_s, double phase_s, const Eigen::Vector3d& bias,
                              double noise_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss(0, noise_m);
  std::vector<TimedPoint> way;
  for (int i = 0; i < 60; ++i) {
    const double t = i / 30.0 + phase_s;
    const Eigen::Vector3d place(0.2 * std::sin(5 * t), 0.1 * std::cos(3 * t),
                                0.05 * std::sin(2 * t));
    way.push_back({t + offset_s,
                   place + bias + Eigen::Vector3d(gauss(random), gauss(random), gauss(random))});
  }
  return way;
}

TEST(ClockOffset, IsFoundToSomeMillisecondsWhateverTheBias) {
  for (const double truth : {-0.4, -0.033, 0.0, 0.012, 0.25}) {
    const auto offset = estimate_clock_offset(waved(0, 0, {0, 0, 0}, 0.003, 1),
                                              waved(truth, 0.007, {0.02, -0.01, 0.03}, 0.003, 2));
    ASSERT_TRUE(offset) << truth;
    EXPECT_NEAR(offset->offset_s, truth, 0.003);
    EXPECT_LT(offset->deviation_s, 0.003);
    EXPECT_LT(std::abs(offset->offset_s - truth), 5 * offset->deviation_s);
  }
}

// Uniform motion along a line could just as well be a constant error.
TEST(ClockOffset, SaysThatItIsUncertainWhereNothingTellsIt) {
  const auto even = [](double offset_s, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> gauss(0, 0.002);
    std::vector<TimedPoint> way;
    for (int i = 0; i < 40; ++i) {
      way.push_back({i / 30.0 + offset_s, Eigen::Vector3d(0.1 * i / 30.0 + gauss(random), 0, 0)});
    }
    return way;
  };
  const auto offset = estimate_clock_offset(even(0, 1), even(0.1, 2));
  EXPECT_TRUE(!offset || offset->deviation_s > 0.01);
  EXPECT_FALSE(estimate_clock_offset({}, even(0, 1)));
}

}  // namespace
}  // namespace diminish
