#include <gtest/gtest.h>

#include <algorithm>

#include "each_vector_target.h"
#include "first_frame.h"
#include "picture_difference.h"

namespace diminish {
namespace {

/// The calendar has one RGB-D camera, the ball is found by its colour, the workbench has two RGB-D
/// cameras to blend: together they take every kernel.
class VectorTargets : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Recordings, VectorTargets,
                         ::testing::Values("calendar", "ball", "workbench"),
                         [](const auto& test) { return std::string(test.param); });

// On every instruction set that this CPU has, and in plain C++, the same pixels are seen, by the
// same cameras, and colours differ by rounding only.
TEST_P(VectorTargets, AgreeOnWholeFrames) {
  const testing::FirstFrame first(GetParam());
  const DiminishedFrame& expected = first.result;
  ASSERT_GT(expected.report.valid_pixels, 5000U);

  testing::on_each_vector_target([&] {
    DiminishedFrame result;
    Pipeline(first.rig(), first.recording.scene, first.options).process(first.frame, result);
    EXPECT_EQ(result.mask, expected.mask);
    EXPECT_EQ(result.provenance, expected.provenance);
    int worst = 0;
    std::size_t others = 0;
    for (int y = 0; y < result.picture.height(); ++y) {
      for (int x = 0; x < result.picture.width(); ++x) {
        const int difference = testing::difference(result.picture(x, y), expected.picture(x, y));
        worst = std::max(worst, difference);
        others += difference > 2 ? 1U : 0U;
      }
    }
    // A seen pixel may be rounded otherwise, and then what is filled from it once more; where a
    // shadow is lifted, by a multiple; and at an edge of what is filled, as far as its sides
    // differ.
    EXPECT_LE(others * 1000, expected.report.mask_pixels);
    EXPECT_LE(worst, 10);
  });
}

}  // namespace
}  // namespace diminish
