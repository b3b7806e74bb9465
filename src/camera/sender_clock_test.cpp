#include "camera/sender_clock.h"

#include <gtest/gtest.h>

namespace diminish {
namespace {

using Clock = Ros2Address::Clock;

constexpr double utc_s = 1.7e9;  ///< less the monotonic clock

TEST(SenderClock, StampsOfAClockLikeOursAreTakenAsTheyAre) {
  SenderClock clock(Clock::automatic);
  EXPECT_FALSE(clock.state());
  // Made at 50, here at 50.03 and 50.08: how long it took is known.
  EXPECT_NEAR(clock.local_s(utc_s + 50, 50.03, utc_s), 50, 1e-6);
  EXPECT_NEAR(clock.local_s(utc_s + 50.04, 50.08, utc_s), 50.04, 1e-6);
  ASSERT_TRUE(clock.state());
  EXPECT_TRUE(clock.state()->is_trusted);
  EXPECT_NEAR(clock.state()->offset_s, -.03, 1e-6);
}

TEST(SenderClock, AnotherClocksStampsAreBroughtToOurs) {
  for (const double ahead_s : {-100., 100., -.5}) {
    SenderClock clock(Clock::automatic);
    EXPECT_NEAR(clock.local_s(utc_s + 50 + ahead_s, 50.03, utc_s), 50.03, 1e-6);
    // 20 ms later than the first, but 50 ms longer on its way.
    EXPECT_NEAR(clock.local_s(utc_s + 50.02 + ahead_s, 50.1, utc_s), 50.05, 1e-6);
    EXPECT_FALSE(clock.state()->is_trusted);
    EXPECT_NEAR(clock.state()->offset_s, ahead_s - .03, 1e-6);
  }
}

TEST(SenderClock, TheUriMayDecide) {
  SenderClock trusted(Clock::synchronized);
  EXPECT_NEAR(trusted.local_s(utc_s + 50, 51, utc_s), 50, 1e-6);
  SenderClock arrival(Clock::arrival);
  EXPECT_NEAR(arrival.local_s(utc_s + 50, 50.03, utc_s), 50.03, 1e-6);
}

TEST(SenderClock, NothingIsMadeAfterItArrived) {
  SenderClock clock(Clock::synchronized);
  EXPECT_EQ(clock.local_s(utc_s + 60, 50, utc_s), 50);
}

}  // namespace
}  // namespace diminish
