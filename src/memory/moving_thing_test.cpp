#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "memory_test_scene.h"

namespace diminish {
namespace {

using testing::hidden;

/// A box moves behind the object, where an RGB-D camera sees it. The memory must not show it where
/// it was, nor the wall where it is now.
class MovingThing : public testing::MemoryTest {
 protected:
  /// Of the pixels that the RGB-D camera sees: how many are nothing like the truth.
  int count_wrong(const Reconstruction& drawn) const {
    constexpr int most = 30;
    int wrong = 0;
    for (int y = hidden.y; y < hidden.bottom(); ++y) {
      for (int x = hidden.x; x < hidden.right(); ++x) {
        if (live.source(x, y) == 0) continue;
        const Bgra& shown = drawn.color(x, y);
        const Bgr& real = truth(x, y);
        const int difference = std::max(
            {std::abs(shown.b - real.b), std::abs(shown.g - real.g), std::abs(shown.r - real.r)});
        wrong += difference > most ? 1 : 0;
      }
    }
    return wrong;
  }
  int count_box_in_truth() const {
    int found = 0;
    for (int y = hidden.y; y < hidden.bottom(); ++y) {
      found +=
          static_cast<int>(std::count_if(truth.row(y) + hidden.x, truth.row(y) + hidden.right(),
                                         [](const Bgr& real) { return real.r > 200; }));
    }
    return found;
  }
  /// From one place to the other; then all pixels of the box have been shown.
  void move_box(double from_m, double to_m, double stamp_s) {
    constexpr int moments = 30;
    for (int i = 0; i <= moments; ++i) {
      SCOPED_TRACE(i);
      show({.stamp_s = stamp_s + 0.1 * i,
            .box_m = from_m + (to_m - from_m) * i / moments,
            .object = hidden});
      most_box_ = std::max(most_box_, count_box_in_truth());
      most_shown_ = std::max(most_shown_, count(result, provenance::witnessed));
      EXPECT_LE(count_wrong(result), count_wrong(live) + 10);
    }
  }

  int most_box_ = 0;
  std::size_t most_shown_ = 0;
};

TEST_F(MovingThing, ThatComesIsShownWhereItIs) {
  show({.stamp_s = 0, .box_m = -0.5});
  move_box(-0.5, 0.25, 0.1);
  EXPECT_GT(most_box_, 5000);
  EXPECT_GT(most_shown_, 5000U);
}

TEST_F(MovingThing, ThatWasRememberedAndGoesIsShownWhereItIs) {
  for (int i = 0; i <= 30; ++i) show({.stamp_s = 0.1 * i});
  move_box(0, 0.5, 3.1);
  EXPECT_GT(most_box_, 5000);
  EXPECT_GT(most_shown_, 5000U);
}

}  // namespace
}  // namespace diminish
