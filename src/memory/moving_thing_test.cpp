#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

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

/// The user walks by, the RGB-D camera is in somebody's hand, and a box drives behind the object: a
/// train. The box is told from all else by its red.
class Train : public testing::MemoryTest {
 protected:
  static bool is_red(const Bgr& color) { return color.r > 200 && color.b < 60; }

  void drive(const std::function<void()>& check) {
    constexpr int moments = 40;
    for (int i = 0; i <= moments; ++i) {
      SCOPED_TRACE(i);
      const double stamp_s = 0.1 * i;
      // The object comes when the user has seen what it will hide.
      show({.stamp_s = stamp_s,
            .box_m = -0.3 + 0.15 * stamp_s,
            .object = i < 10 ? Rect{} : hidden,
            .user_m = 0.02 * stamp_s,
            .rgbd_m = 0.004 * std::sin(7 * stamp_s)});
      if (i >= 10) check();
    }
  }
};

TEST_F(Train, IsLiveInEveryFrame) {
  int of_train = 0;
  drive([&] {
    int remembered = 0;
    int seen = 0;
    for (int y = hidden.y; y < hidden.bottom(); ++y) {
      for (int x = hidden.x; x < hidden.right(); ++x) {
        const Bgra& now = live.color(x, y);
        if (live.source(x, y) == 0 || !is_red(truth(x, y)) || !is_red({now.b, now.g, now.r}))
          continue;
        ++seen;
        remembered += result.source(x, y) >= provenance::witnessed ? 1 : 0;
      }
    }
    of_train += seen;
    EXPECT_EQ(remembered, 0) << "of " << seen;
  });
  EXPECT_GT(of_train, 50000);
}

TEST_F(Train, IsNeverDoubled) {
  std::size_t most_remembered = 0;
  drive([&] {
    int doubled = 0;
    for (int y = hidden.y; y < hidden.bottom(); ++y) {
      for (int x = hidden.x; x < hidden.right(); ++x) {
        const Bgra& shown = result.color(x, y);
        const bool is_shown = result.source(x, y) >= provenance::witnessed;
        doubled += is_shown && is_red({shown.b, shown.g, shown.r}) && !is_red(truth(x, y)) ? 1 : 0;
      }
    }
    EXPECT_LE(doubled, 20);
    most_remembered = std::max(most_remembered, count(result, provenance::witnessed) +
                                                    count(result, provenance::remembered));
  });
  EXPECT_GT(most_remembered, pixels / 3);
}

// A fan is taken off the desk while the object hides it from the user.
TEST_F(Train, ThatIsTakenAwayIsNotShownFromTheFirstFrameOn) {
  for (int i = 0; i <= 40; ++i) {
    SCOPED_TRACE(i);
    const double stamp_s = 0.1 * i;
    const bool has_box = i < 20;
    const bool is_witnessed = i < 30;
    show({.stamp_s = stamp_s,
          .has_box = has_box,
          .object = i < 10 ? Rect{} : hidden,
          .is_witnessed = is_witnessed,
          .user_m = 0.02 * stamp_s,
          .rgbd_m = 0.004 * std::sin(7 * stamp_s)});
    if (i < 10) continue;
    if (has_box) {
      EXPECT_GT(count_box(result), 2500);
    } else {
      EXPECT_LT(count_box(result), is_witnessed ? 100 : 3000);
    }
  }
}

}  // namespace
}  // namespace diminish
