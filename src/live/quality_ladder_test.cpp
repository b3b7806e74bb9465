#include "live/quality_ladder.h"

#include <gmock/gmock.h>

#include <vector>

namespace diminish {
namespace {

/// A machine on which a frame takes `full_ms` at level 0, and each step saves a tenth of it.
double frame_ms(double full_ms, int level) {
  return full_ms * (1 - 0.1 * level);
}

/// The levels of `frames` frames.
std::vector<int> levels(QualityLadder& ladder, double full_ms, double budget_ms, int frames) {
  std::vector<int> result;
  for (int i = 0; i < frames; ++i) {
    result.push_back(ladder.next_level(frame_ms(full_ms, ladder.level()), budget_ms));
  }
  return result;
}

TEST(QualityLadder, StaysWhereTimeIsEnough) {
  QualityLadder ladder;
  EXPECT_THAT(levels(ladder, 20, 33, 500), ::testing::Each(0));
}

TEST(QualityLadder, OneLateFrameIsNoReason) {
  QualityLadder ladder;
  ladder.next_level(100, 33);
  EXPECT_THAT(levels(ladder, 20, 33, 10), ::testing::Each(0));
}

TEST(QualityLadder, StepsDownUntilTheBudgetIsKept) {
  QualityLadder ladder;
  levels(ladder, 40, 33, 100);
  EXPECT_LE(frame_ms(40, ladder.level()), 33);
  EXPECT_GT(frame_ms(40, ladder.level() - 1), 33) << "no further than that";
}

TEST(QualityLadder, ComesBackWhenThereIsTime) {
  QualityLadder ladder;
  levels(ladder, 60, 33, 100);
  EXPECT_GE(ladder.level(), 4);
  levels(ladder, 15, 33, 1000);
  EXPECT_EQ(ladder.level(), 0);
}

TEST(QualityLadder, DoesNotSwingBetweenTwoLevels) {
  // Level 0 takes too long, and one level lower is so fast that there seems to be time for more.
  QualityLadder ladder;
  int changes = 0;
  int last = 0;
  for (int i = 0; i < 3000; ++i) {
    const int level = ladder.next_level(ladder.level() == 0 ? 40 : 20, 33);
    changes += level != last ? 1 : 0;
    last = level;
  }
  EXPECT_LE(changes, 20);
}

TEST(QualityLadder, WithoutABudgetEverythingIsAsChosen) {
  QualityLadder ladder;
  levels(ladder, 60, 33, 100);
  EXPECT_EQ(ladder.next_level(1000, 0), 0);
}

TEST(QualityLadder, EveryLevelIsAllowedAndSaysWhatItSimplifies) {
  Options options;
  options.whole_view = true;
  options.remove_shadows = true;
  for (int level = 0; level <= QualityLadder::last_level(); ++level) {
    EXPECT_NO_THROW(check(QualityLadder::simplified(options, level)));
    EXPECT_EQ(QualityLadder::description(level).empty(), level == 0);
    if (level == 0) continue;
    EXPECT_THAT(QualityLadder::description(level),
                ::testing::StartsWith(QualityLadder::description(level - 1)));
  }
}

TEST(QualityLadder, WhatTheUserChoseSimplerStays) {
  Options options;
  options.inpaint = "none";
  options.color_correct = "none";
  options.mode = "half";
  options.mask_margin_px = 9;
  const Options simplest = QualityLadder::simplified(options, QualityLadder::last_level());
  EXPECT_EQ(simplest.inpaint, "none");
  EXPECT_EQ(simplest.color_correct, "none");
  EXPECT_EQ(simplest.mode, "half");
  EXPECT_EQ(simplest.mask_margin_px, 9);
}

}  // namespace
}  // namespace diminish
