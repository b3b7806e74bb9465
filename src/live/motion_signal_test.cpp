#include "live/motion_signal.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace diminish {
namespace {

/// Somebody waving: bursts of motion that do not repeat.
double waving(double time_s) {
  return 3 + 2 * std::sin(2 * time_s) + std::sin(5.3 * time_s + 1) + 0.5 * std::sin(11.1 * time_s);
}

/// The motion as a camera with another clock, frame rate and view sees it, with noise.
std::vector<MotionSample> seen(double offset_s, double rate, double gain, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.1);
  std::vector<MotionSample> signal;
  for (double time_s = 0.3 / rate; time_s < 10; time_s += 1 / rate) {
    signal.push_back({time_s + offset_s, gain * waving(time_s) + noise(random)});
  }
  return signal;
}

TEST(SyncOffset, IsFoundToAFewMilliseconds) {
  for (const double offset_s : {-0.31, -0.02, 0.0, 0.013, 0.2}) {
    const auto found = estimate_sync_offset(seen(0, 30, 1, 1), seen(offset_s, 30, 0.6, 2));
    ASSERT_TRUE(found) << offset_s;
    EXPECT_NEAR(found->offset_s, offset_s, 0.004);
    EXPECT_GT(found->correlation, 0.9);
  }
}

TEST(SyncOffset, CamerasMayHaveDifferentRates) {
  const auto found = estimate_sync_offset(seen(0, 30, 1, 1), seen(0.07, 15, 1, 2));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->offset_s, 0.07, 0.008);
}

TEST(SyncOffset, StillnessAndOtherMotionSayNothing) {
  const std::vector<MotionSample> wave = seen(0, 30, 1, 1);
  EXPECT_FALSE(estimate_sync_offset(wave, seen(0, 30, 0, 2)));
  std::vector<MotionSample> other = seen(0, 30, 1, 3);
  std::mt19937 random(5);
  for (MotionSample& motion : other) motion.amount = std::normal_distribution<double>(3, 2)(random);
  EXPECT_FALSE(estimate_sync_offset(wave, other));
  EXPECT_FALSE(estimate_sync_offset(wave, {}));
  EXPECT_FALSE(estimate_sync_offset(wave, seen(1.6, 30, 1, 4)))
      << "further apart than is looked for";
}

TEST(MotionMeter, MeasuresWhatMoves) {
  MotionMeter meter;
  Image<Bgr> image(320, 240, {50, 50, 50});
  EXPECT_FALSE(meter.add(image, 1));
  const auto still = meter.add(image, 1 + 1.0 / 30);
  ASSERT_TRUE(still);
  EXPECT_EQ(still->amount, 0);
  EXPECT_NEAR(still->stamp_s, 1 + 0.5 / 30, 1e-9);
  image.fill(Rect{0, 0, 160, 240}, {90, 90, 90});  // half of the picture, by 40 levels
  EXPECT_NEAR(meter.add(image, 1 + 2.0 / 30)->amount, 20, 1e-6);
  EXPECT_FALSE(meter.add(Image<Bgr>(10, 10), 2)) << "another size";
}

}  // namespace
}  // namespace diminish
