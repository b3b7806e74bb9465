#include "core/backoff.h"

#include <gtest/gtest.h>

#include <vector>

namespace diminish {
namespace {

/// Frames in which it tries, of `count`, where all tries fail.
std::vector<int> failing_tries(Backoff& backoff, int count) {
  std::vector<int> tries;
  for (int frame = 0; frame < count; ++frame) {
    if (!backoff.is_due()) continue;
    tries.push_back(frame);
    backoff.fail();
  }
  return tries;
}

TEST(Backoff, TriesAtOnceAndThenEverLater) {
  Backoff backoff;
  const std::vector<int> tries = failing_tries(backoff, 10'000);
  ASSERT_GT(tries.size(), 12U);
  EXPECT_EQ(tries[0], 0);
  EXPECT_EQ(tries[1], 1);
  int longest = 1;
  for (std::size_t i = 2; i < tries.size(); ++i) {
    const int gap = tries[i] - tries[i - 1];
    EXPECT_EQ(gap, std::min(2 * longest, 1024)) << "the gaps double, up to half a minute at 30 Hz";
    longest = gap;
  }
  EXPECT_EQ(longest, 1024);
}

TEST(Backoff, WhatWorksAgainIsTriedAtOnceWhenItFailsAgain) {
  Backoff backoff;
  failing_tries(backoff, 500);
  while (!backoff.is_due()) {
  }
  backoff.succeed();
  EXPECT_EQ(failing_tries(backoff, 4), (std::vector<int>{0, 1, 3}));
}

}  // namespace
}  // namespace diminish
