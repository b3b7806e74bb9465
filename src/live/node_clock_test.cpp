#include "live/node_clock.h"

#include <gtest/gtest.h>

#include <random>

namespace diminish {
namespace {

// Ways of 0.2 ms and more: the shortest tells the clock.
TEST(NodeClock, ShortWaysTellTheOffset) {
  NodeClock clock;
  EXPECT_FALSE(clock.offset_s());
  std::mt19937 random(1);
  std::exponential_distribution<double> late(1 / 0.004);
  constexpr double offset_s = 1234.5;
  for (int i = 0; i < 200; ++i) {
    const double asked_s = i / 30.;
    const double received_s = asked_s + 0.0002 + late(random) + offset_s;
    const double sent_s = received_s + 0.01;
    clock.add(asked_s, received_s, sent_s, sent_s - offset_s + 0.0002 + late(random));
  }
  EXPECT_NEAR(*clock.offset_s(), offset_s, 0.001);
}

TEST(NodeClock, AnotherMachineIsNoticedAtOnce) {
  NodeClock clock;
  for (int i = 0; i < 10; ++i) clock.add(i, i + 50.001, i + 50.002, i + 0.003);
  EXPECT_NEAR(*clock.offset_s(), 50, 1e-9);
  clock.add(11, 11 - 7 + 0.001, 11 - 7 + 0.002, 11.003);
  EXPECT_NEAR(*clock.offset_s(), -7, 1e-9);
}

// As if it had come before it was sent.
TEST(NodeClock, NonsenseIsLeftOut) {
  NodeClock clock;
  clock.add(1, 2, 9, 1.5);
  EXPECT_FALSE(clock.offset_s());
}

}  // namespace
}  // namespace diminish
