#include <gtest/gtest.h>

#include "memory_test_scene.h"

namespace diminish {
namespace {

using testing::hidden;

/// The user has never seen what the object hides. An RGB-D camera has, and has moved since.
class MovingRgbd : public testing::MemoryTest {
 protected:
  /// The camera moves to a place and on. Then it is gone.
  const Reconstruction& sweep(const Moment& there) {
    show({.stamp_s = 0, .object = hidden, .wave_m = there.wave_m});
    show(there);
    for (const double later_s : {0.1, 0.2}) {
      show({.stamp_s = there.stamp_s + later_s,
            .has_box = there.has_box,
            .object = hidden,
            .is_witnessed = false,
            .wave_m = there.wave_m});
    }
    return result;
  }
  std::size_t count_earlier() const {
    return count(result, provenance::witnessed) + count(result, provenance::remembered);
  }
};

TEST_F(MovingRgbd, IsRemembered) {
  sweep({.stamp_s = 0.3, .object = hidden, .rgbd_m = 0.05});
  EXPECT_GT(count(result, provenance::remembered), pixels * 8 / 10);
  EXPECT_LT(error(result, provenance::remembered), 8);
  EXPECT_GT(count_box(result), 2000);
}

TEST_F(MovingRgbd, IsNotRememberedIfItStandsStill) {
  for (const double stamp_s : {0., 0.3, 0.6, 0.9}) {
    show({.stamp_s = stamp_s, .object = hidden, .rgbd_m = 0.015 * stamp_s});
    EXPECT_EQ(count_earlier(), 0U);
  }
  // What it saw has had time to change.
  show({.stamp_s = 1.2, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(count_earlier(), 0U);
}

// By 1.7 degrees: as much as a marker and a calibration leave open together.
TEST_F(MovingRgbd, IsAlignedThoughItsPoseIsWrong) {
  constexpr double even_m = 0.15;
  sweep({.stamp_s = 0.3, .object = hidden, .rgbd_m = 0.05, .wave_m = even_m});
  const double right = error(result, provenance::remembered);
  memory.forget();
  sweep({.stamp_s = 0.3, .object = hidden, .rgbd_m = 0.05, .rgbd_turn = 0.03, .wave_m = even_m});
  EXPECT_GT(count(result, provenance::remembered), pixels * 7 / 10);
  EXPECT_LT(error(result, provenance::remembered), right + 1);
}

TEST_F(MovingRgbd, IsWitnessedFromWhereItStandsNow) {
  show({.stamp_s = 0, .object = hidden, .rgbd_m = 0.2});
  show({.stamp_s = 0.3, .object = hidden, .rgbd_m = 0.25});  // near the user
  show({.stamp_s = 0.6, .object = hidden, .rgbd_m = -0.2});
  show({.stamp_s = 0.8, .object = hidden, .rgbd_m = -0.2});
  EXPECT_GT(count(result, provenance::witnessed), pixels / 2);
  EXPECT_LT(error(result, provenance::witnessed), 8);
}

TEST_F(MovingRgbd, ForgetsWhatIsGone) {
  show({.stamp_s = 0, .object = hidden, .rgbd_m = 0.2});
  show({.stamp_s = 0.3, .object = hidden, .rgbd_m = 0.25});
  for (const double stamp_s : {0.6, 0.8}) {
    show({.stamp_s = stamp_s, .has_box = false, .object = hidden, .rgbd_m = 0.25});
    EXPECT_LT(count_box(result), 100);
  }
  show({.stamp_s = 0.9, .has_box = false, .object = hidden, .is_witnessed = false});
  EXPECT_LT(count_box(result), 100);
}

TEST_F(MovingRgbd, IsNotLearntFromWhileItIsInDoubt) {
  sweep({.stamp_s = 0.3, .object = hidden, .rgbd_m = 0.05, .is_in_doubt = true});
  EXPECT_EQ(count_earlier(), 0U);
}

TEST_F(MovingRgbd, IsOnlyWitnessedIfToldSo) {
  options.memory = "witnessed";
  sweep({.stamp_s = 0.3, .object = hidden, .rgbd_m = 0.05});
  EXPECT_EQ(count_earlier(), 0U);
}

}  // namespace
}  // namespace diminish
