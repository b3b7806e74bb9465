#include "ros/clock_estimate.h"

#include <gtest/gtest.h>

#include <random>

namespace diminish::ros {
namespace {

/// A camera at 30 images/s on a clock that is `offset_s` behind ours and loses `drift` of a second
/// each second; ways take 2 ms at least, usually 5 ms more.
class Sender {
 public:
  Sender(double offset_s, double drift) : offset_s_(offset_s), drift_(drift) {}

  void send(double seconds, ClockEstimate& estimate) {
    for (const double end_s = now_s_ + seconds; now_s_ < end_s; now_s_ += 1. / 30) {
      estimate.add(stamp_s(), now_s_ + .002 + late_(random_));
    }
  }
  double stamp_s() const { return (now_s_ - offset_s_) / (1 + drift_); }
  double now_s() const { return now_s_; }

 private:
  double offset_s_, drift_, now_s_ = 1000;
  std::mt19937 random_{7};
  std::exponential_distribution<double> late_{200};
};

TEST(ClockEstimate, FindsOffsetAndDrift) {
  for (const double drift : {0., 30e-6, -80e-6}) {
    Sender sender(-1.7e9, drift);
    ClockEstimate estimate;
    sender.send(120, estimate);
    const double truth_s = sender.now_s() - sender.stamp_s();
    EXPECT_NEAR(estimate.offset_s(sender.stamp_s()), truth_s + .002, .0006) << drift;
    EXPECT_NEAR(estimate.drift(), drift, 8e-6);
  }
}

TEST(ClockEstimate, TheFirstSecondsHaveTheShortestWay) {
  Sender sender(5, 0);
  ClockEstimate estimate;
  EXPECT_TRUE(estimate.empty());
  sender.send(3, estimate);
  EXPECT_FALSE(estimate.empty());
  EXPECT_EQ(estimate.drift(), 0);
  EXPECT_NEAR(estimate.offset_s(sender.stamp_s()), 5.002, .001);
}

TEST(ClockEstimate, FollowsAClockThatIsSet) {
  for (const double to_s : {-3., 3., 1e6, -1e6}) {
    Sender sender(0, 0);
    ClockEstimate estimate;
    sender.send(20, estimate);
    Sender set(to_s, 0);
    set.send(1, estimate);
    EXPECT_NEAR(estimate.offset_s(set.stamp_s()), to_s + .002, .002) << to_s;
  }
}

TEST(ClockEstimate, AMessageThatWasHeldUpChangesNothing) {
  Sender sender(0, 0);
  ClockEstimate estimate;
  sender.send(20, estimate);
  const double before_s = estimate.offset_s(sender.stamp_s());
  estimate.add(sender.stamp_s(), sender.now_s() + 4);
  EXPECT_EQ(estimate.offset_s(sender.stamp_s()), before_s);
}

}  // namespace
}  // namespace diminish::ros
