#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <algorithm>

#include "first_frame.h"
#include "picture_difference.h"

namespace diminish {
namespace {

/// Has the kernels take one of the instruction sets that they were compiled for.
class OnTarget {
 public:
  explicit OnTarget(std::int64_t target) { hwy::SetSupportedTargetsForTest(target); }
  ~OnTarget() { hwy::SetSupportedTargetsForTest(0); }
  OnTarget(const OnTarget&) = delete;
  OnTarget& operator=(const OnTarget&) = delete;
};

// Whole frames on every instruction set that this processor has, down to plain C++: the same pixels
// are seen, and colours differ by rounding only.
TEST(VectorTargets, AgreeOnWholeFrames) {
  const testing::FirstFrame first("calendar");
  const DiminishedFrame& expected = first.result;
  ASSERT_GT(expected.report.valid_pixels, 50000U);

  int targets = 0;
  std::int64_t remaining = hwy::SupportedTargets() & HWY_TARGETS;
  while (remaining != 0) {
    const std::int64_t target = remaining & -remaining;
    remaining &= remaining - 1;
    SCOPED_TRACE(hwy::TargetName(target));
    const OnTarget chosen(target);
    DiminishedFrame result;
    Pipeline(first.rig(), first.recording.scene, first.options).process(first.frame, result);
    EXPECT_EQ(result.mask, expected.mask);
    EXPECT_EQ(result.provenance, expected.provenance);
    int worst = 0;
    for (int y = 0; y < result.picture.height(); ++y) {
      for (int x = 0; x < result.picture.width(); ++x) {
        worst = std::max(worst, testing::difference(result.picture(x, y), expected.picture(x, y)));
      }
    }
    // A seen pixel may be rounded otherwise, and then what is filled from it, once more; where a
    // shadow is lifted, by a multiple.
    EXPECT_LE(worst, 4);
    ++targets;
  }
  EXPECT_GE(targets, 1);
}

}  // namespace
}  // namespace diminish
