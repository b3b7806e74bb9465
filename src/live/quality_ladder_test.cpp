#include "live/quality_ladder.h"

#include <gmock/gmock.h>

#include <vector>

namespace diminish {
namespace {

/// Options that each level simplifies.
Options elaborate() {
  Options options;
  options.whole_view = true;
  options.remove_shadows = true;
  return options;
}

/// A machine on which a frame takes `full_ms` at level 0, and each step saves a tenth of it.
double frame_ms(double full_ms, int level) {
  return full_ms * (1 - 0.1 * level);
}

/// The levels of `frames` frames.
std::vector<int> levels(QualityLadder& ladder, double full_ms, double budget_ms, int frames,
                        const Options& options = elaborate()) {
  std::vector<int> result;
  for (int i = 0; i < frames; ++i) {
    result.push_back(ladder.next_level(frame_ms(full_ms, ladder.level()), budget_ms, options));
  }
  return result;
}

TEST(QualityLadder, StaysWhereTimeIsEnough) {
  QualityLadder ladder;
  EXPECT_THAT(levels(ladder, 20, 33, 500), ::testing::Each(0));
}

TEST(QualityLadder, AFewLateFramesAreNoReason) {
  QualityLadder ladder;
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(ladder.next_level(i % 5 < 2 ? 100 : 20, 33, elaborate()), 0);
  }
}

TEST(QualityLadder, StepsDownUntilTheBudgetIsKept) {
  QualityLadder ladder;
  levels(ladder, 40, 33, 100);
  EXPECT_LE(frame_ms(40, ladder.level()), 33);
  EXPECT_GT(frame_ms(40, ladder.level() - 1), 33) << "no further than that";
}

// Beside other programs a frame takes its usual time or far longer, depending on who has the cores.
TEST(QualityLadder, StepsDownBesideOtherProgramsAndComesBackAfterThem) {
  QualityLadder ladder;
  levels(ladder, 25, 33, 100);
  for (int i = 0; i < 200; ++i) {
    const double others = i % 3 == 0 ? 1 : 4;
    ladder.next_level(others * frame_ms(25, ladder.level()), 33, elaborate());
  }
  EXPECT_EQ(ladder.level(), QualityLadder::last_level);
  EXPECT_EQ(levels(ladder, 25, 33, 500).back(), 0);
}

// They leave just when a step is taken, so that it seems to save most of the time.
TEST(QualityLadder, ForgetsWhatAStepDidNotSave) {
  QualityLadder ladder;
  while (ladder.level() == 0) ladder.next_level(100, 33, elaborate());
  EXPECT_EQ(levels(ladder, 25, 33, 100).back(), 1);
  EXPECT_EQ(levels(ladder, 25, 33, 3000).back(), 0);
}

TEST(QualityLadder, ComesBackWhenThereIsTime) {
  QualityLadder ladder;
  levels(ladder, 60, 33, 100);
  EXPECT_GE(ladder.level(), 4);
  levels(ladder, 15, 33, 1000);
  EXPECT_EQ(ladder.level(), 0);
}

TEST(QualityLadder, DoesNotSwingBetweenTwoLevels) {
  // Level 0 is too slow, level 1 so fast that there seems to be time for more.
  QualityLadder ladder;
  int changes = 0;
  int last = 0;
  for (int i = 0; i < 3000; ++i) {
    const int level = ladder.next_level(ladder.level() == 0 ? 40 : 20, 33, elaborate());
    changes += level != last ? 1 : 0;
    last = level;
  }
  EXPECT_LE(changes, 20);
  EXPECT_GE(changes, 3) << "it tries again now and then";
}

TEST(QualityLadder, WithoutABudgetEverythingIsAsChosen) {
  QualityLadder ladder;
  levels(ladder, 60, 33, 100);
  EXPECT_EQ(ladder.next_level(1000, 0, elaborate()), 0);
}

TEST(QualityLadder, PassesOverWhatIsSimpleAlready) {
  Options options;  // without `whole_view` and `remove_shadows`: level 1 changes nothing
  options.lift_shadows = false;
  QualityLadder ladder;
  const std::vector<int> down = levels(ladder, 1000, 33, 100, options);
  EXPECT_EQ(down.back(), QualityLadder::last_level);
  const std::vector<int> up = levels(ladder, 1, 33, 1000, options);
  EXPECT_EQ(up.back(), 0);
  for (const auto& some : {down, up}) {
    EXPECT_THAT(some, ::testing::Not(::testing::Contains(1)));
    EXPECT_THAT(some, ::testing::Not(::testing::Contains(4)));
  }
  EXPECT_EQ(QualityLadder::description(options, 1), "");
  EXPECT_EQ(QualityLadder::description(options, 2), "depth edges stay where they are");

  Options simplest = QualityLadder::simplified(options, QualityLadder::last_level);
  QualityLadder idle;
  EXPECT_THAT(levels(idle, 1000, 33, 100, simplest), ::testing::Each(0));
}

TEST(QualityLadder, EveryLevelIsAllowedAndSaysWhatItSimplifies) {
  const Options options = elaborate();
  for (int level = 0; level <= QualityLadder::last_level; ++level) {
    EXPECT_NO_THROW(check(QualityLadder::simplified(options, level)));
    const std::string description = QualityLadder::description(options, level);
    EXPECT_EQ(description.empty(), level == 0);
    if (level == 0) continue;
    const std::string before = QualityLadder::description(options, level - 1);
    EXPECT_THAT(description, ::testing::StartsWith(before));
    EXPECT_NE(description, before);
  }
}

TEST(QualityLadder, WhatTheUserChoseSimplerStays) {
  Options options;
  options.inpaint = "none";
  options.color_correct = "none";
  options.mode = "half";
  options.mask_margin_px = 9;
  const Options simplest = QualityLadder::simplified(options, QualityLadder::last_level);
  EXPECT_EQ(simplest.inpaint, "none");
  EXPECT_EQ(simplest.color_correct, "none");
  EXPECT_EQ(simplest.mode, "half");
  EXPECT_EQ(simplest.mask_margin_px, 9);
}

}  // namespace
}  // namespace diminish
