#include "memory/memory_stage.h"

#include <gtest/gtest.h>

#include "memory_test_scene.h"

namespace diminish {
namespace {

using testing::hidden;

class Memory : public testing::MemoryTest {};

TEST_F(Memory, ShowsTheUsersOwnPixelsWhereTheyAreWitnessed) {
  show({.stamp_s = 0});
  const Reconstruction& shown = show({.stamp_s = 0.3, .object = hidden});
  EXPECT_GT(count(shown, provenance::witnessed), pixels * 7 / 10);
  EXPECT_LT(error(shown, provenance::witnessed), 3);
}

TEST_F(Memory, RemembersWhereNobodyLooks) {
  show({.stamp_s = 0});
  const Reconstruction& shown = show({.stamp_s = 0.3, .object = hidden, .is_witnessed = false});
  EXPECT_GT(count(shown, provenance::remembered), pixels * 9 / 10);
  EXPECT_LT(error(shown, provenance::remembered), 5);
}

TEST_F(Memory, ShowsOnlyWhatIsWitnessedIfToldSo) {
  options.memory = "witnessed";
  show({.stamp_s = 0});
  EXPECT_GT(count(show({.stamp_s = 0.3, .object = hidden}), provenance::witnessed), pixels / 2);
  EXPECT_EQ(count(result, provenance::remembered), 0U);
  show({.stamp_s = 0.6, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(count(result, 0), pixels);
}

TEST_F(Memory, ForgetsWhatIsGoneAtOnceAndForEver) {
  show({.stamp_s = 0});
  EXPECT_LT(count_box(show({.stamp_s = 0.3, .has_box = false, .object = hidden})), 100);
  EXPECT_LT(
      count_box(show({.stamp_s = 0.6, .has_box = false, .object = hidden, .is_witnessed = false})),
      100);
}

TEST_F(Memory, ShowsWhatHasComeAsItIsNow) {
  show({.stamp_s = 0, .has_box = false});
  const Reconstruction& shown = show({.stamp_s = 0.3, .object = hidden});
  EXPECT_GT(count_box(shown), 2500);
  EXPECT_LT(error(shown, provenance::first_rgbd), 12);
}

TEST_F(Memory, LearnsNothingUnderTheObjects) {
  show({.stamp_s = 0, .object = hidden});
  const Reconstruction& shown = show({.stamp_s = 0.3, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(count(shown, provenance::remembered), 0U);
}

TEST_F(Memory, ShowsNoSpecks) {
  const auto remembered_through = [&](const Rect& hole) {
    memory.forget();
    show({.stamp_s = 0, .object = hidden, .hole = hole});
    return count(show({.stamp_s = 0.3, .object = hidden, .is_witnessed = false}),
                 provenance::remembered);
  };
  EXPECT_GT(remembered_through({120, 95, 60, 50}), 800U);
  EXPECT_EQ(remembered_through({150, 110, 24, 24}), 0U);
}

TEST_F(Memory, LearnsNothingThatOnlyPasses) {
  show({.stamp_s = 0, .has_box = false});
  show({.stamp_s = 0.5});
  show({.stamp_s = 1});
  const Reconstruction& shown =
      show({.stamp_s = 1.5, .has_box = false, .object = hidden, .is_witnessed = false});
  EXPECT_LT(count_box(shown), 100);
  EXPECT_GT(count(shown, provenance::remembered), pixels * 9 / 10);
}

TEST_F(Memory, LearnsWhatHasStayed) {
  show({.stamp_s = 0, .has_box = false});
  for (const double stamp_s : {2., 4., 6.}) show({.stamp_s = stamp_s});
  const Reconstruction& shown = show({.stamp_s = 6.3, .object = hidden});
  EXPECT_GT(count_box(shown), 2500);
  EXPECT_GT(count(shown, provenance::witnessed), pixels * 6 / 10);
  EXPECT_LT(error(shown, provenance::witnessed), 3);
}

TEST_F(Memory, LearnsNothingWhileAnObjectIsLost) {
  show({.stamp_s = 0, .object = hidden});
  show({.stamp_s = 0.5, .is_lost = true});
  const Reconstruction& shown = show({.stamp_s = 1, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(count(shown, provenance::remembered), 0U);
}

TEST_F(Memory, LearnsNothingWhileACameraIsInDoubt) {
  show({.stamp_s = 0, .is_in_doubt = true});
  EXPECT_EQ(memory_report.keyframes, 0U);
  show({.stamp_s = 0.3});
  EXPECT_EQ(memory_report.keyframes, 1U);
}

TEST_F(Memory, ForgetsWithAge) {
  options.memory_max_age_s = 5;
  show({.stamp_s = 0});
  show({.stamp_s = 4, .object = hidden, .is_witnessed = false});
  EXPECT_GT(count(result, provenance::remembered), 0U);
  show({.stamp_s = 6, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(count(result, provenance::remembered), 0U);
}

// Parked in front of something for longer than anything is remembered.
TEST_F(Memory, ForgetsNothingThatIsStillWitnessed) {
  options.memory_max_age_s = 5;
  show({.stamp_s = 0});
  std::size_t first = 0;
  for (int second = 1; second <= 12; ++second) {
    show({.stamp_s = 1. * second, .object = hidden});
    if (second == 1) first = count(result, provenance::witnessed);
  }
  EXPECT_GT(first, pixels * 7 / 10);
  EXPECT_GT(count(result, provenance::witnessed), first * 95 / 100);
  EXPECT_LT(error(result, provenance::witnessed), 3);
  EXPECT_LT(count(result, provenance::remembered), pixels / 50) << "nobody saw it for 12 s";
  show({.stamp_s = 16, .object = hidden, .is_witnessed = false});
  EXPECT_GT(count(result, provenance::remembered), pixels / 2) << "witnessed 4 s ago";
  show({.stamp_s = 18, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(count(result, provenance::remembered), 0U);
}

// A lamp is dimmed, then turned up: all that is remembered is shown in the light of now.
TEST_F(Memory, FollowsTheLight) {
  constexpr double even_m = 0.5;  // colours that change little from pixel to pixel
  show({.stamp_s = 0, .wave_m = even_m});
  double stamp_s = 0;
  for (const double light : {1., 0.7, 0.5, 0.9}) {
    SCOPED_TRACE(light);
    Moment moment{.stamp_s = stamp_s += 0.3, .object = hidden, .light = light, .wave_m = even_m};
    show(moment);
    EXPECT_GT(count(result, provenance::witnessed), pixels / 2);
    EXPECT_LT(error(result, provenance::witnessed), 4);
    moment.stamp_s = stamp_s += 0.3;
    moment.is_witnessed = false;
    show(moment);
    EXPECT_GT(count(result, provenance::remembered), pixels * 9 / 10);
    EXPECT_LT(error(result, provenance::remembered), 6);
  }
}

TEST_F(Memory, SaysHowOldWhatIsRememberedIs) {
  show({.stamp_s = 1});
  EXPECT_EQ(memory_report.keyframes, 1U);
  EXPECT_GT(memory_report.bytes, rig.color.width * rig.color.height * sizeof(Bgr));
  EXPECT_EQ(memory_report.oldest_age_s, 0);
  // What is under the object is not learnt again.
  show({.stamp_s = 3.5, .object = hidden});
  show({.stamp_s = 4, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(memory_report.keyframes, 2U);
  EXPECT_DOUBLE_EQ(memory_report.median_age_s, 3);
  EXPECT_DOUBLE_EQ(memory_report.oldest_age_s, 3);
}

TEST_F(Memory, ForgetsWhenToldAndWhenARecordingBeginsAnew) {
  for (const bool is_told : {false, true}) {
    show({.stamp_s = 10});
    if (is_told) memory.forget();
    show({.stamp_s = is_told ? 11. : 0., .object = hidden, .is_witnessed = false});
    EXPECT_EQ(count(result, provenance::remembered), 0U);
  }
}

// The user's camera was moved, and its pose does not say so.
TEST_F(Memory, ShowsNothingInAWrongPlace) {
  show({.stamp_s = 0});
  show({.stamp_s = 0.3, .object = hidden, .turn = 0.3});
  EXPECT_EQ(count(result, provenance::witnessed) + count(result, provenance::remembered), 0U);
}

TEST_F(Memory, WaitsWithoutAPose) {
  show({.stamp_s = 0});
  show({.stamp_s = 0.3, .object = hidden, .has_pose = false});
  EXPECT_EQ(count(result, 0), pixels);
  show({.stamp_s = 0.6, .object = hidden, .is_witnessed = false});
  EXPECT_GT(count(result, provenance::remembered), pixels * 9 / 10);
}

TEST_F(Memory, LearnsNothingFromAPoseThatJumps) {
  show({.stamp_s = 0});
  show({.stamp_s = 0.3, .turn = 2});  // more than a camera turns in that time
  EXPECT_EQ(memory_report.keyframes, 1U);
  show({.stamp_s = 0.6, .turn = 2});  // it stands there
  EXPECT_EQ(memory_report.keyframes, 2U);
}

// The recording goes on somewhere else, as if nothing had happened.
TEST_F(Memory, ShowsNothingOfBeforeACut) {
  show({.stamp_s = 0});
  for (const bool is_witnessed : {true, false}) {
    show({.stamp_s = 0.1, .object = hidden, .is_witnessed = is_witnessed, .is_elsewhere = true});
    EXPECT_EQ(count(result, provenance::witnessed) + count(result, provenance::remembered), 0U);
  }
}

// Where no marker is the world, the first RGB-D camera is.
TEST_F(Memory, NeedsNoWorldWhereTheCamerasStandStill) {
  show({.stamp_s = 0, .has_world = false});
  show({.stamp_s = 0.3, .object = hidden, .has_world = false});
  EXPECT_GT(count(result, provenance::witnessed), pixels * 7 / 10);
}

TEST_F(Memory, ForgetsWhenTheCameraThatIsTheWorldIsMoved) {
  show({.stamp_s = 0, .has_world = false});
  show({.stamp_s = 0.3, .object = hidden, .has_world = false, .moved_m = 0.1});
  EXPECT_EQ(count(result, provenance::witnessed) + count(result, provenance::remembered), 0U);
  EXPECT_EQ(memory_report.keyframes, 1U) << "that of now";
}

}  // namespace
}  // namespace diminish
