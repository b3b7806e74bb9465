#include <gtest/gtest.h>

#include <cmath>

#include "diminish/reconstruction.h"

namespace diminish {
namespace {

// The paper's figures: 0.156 degrees between depth pixels, a threshold of 5 cm.
TEST(SmallestVisibleSurfaceAngle, AgreesWithThePaper) {
  EXPECT_NEAR(smallest_visible_surface_angle_deg(5, 0.156, 0.05), 15.2, 0.06);
  EXPECT_NEAR(smallest_visible_surface_angle_deg(2.5, 0.156, 0.05), 7.7, 0.06);
}

// A surface seen at 45 degrees: the depth difference equals the spacing of the pixels.
TEST(SmallestVisibleSurfaceAngle, IsHalfARightAngleWhereTheThresholdEqualsThePixelSpacing) {
  const double spacing = 2 * std::tan(0.2 * 3.14159265358979 / 180);
  EXPECT_NEAR(smallest_visible_surface_angle_deg(2, 0.2, spacing), 45, 1e-9);
}

}  // namespace
}  // namespace diminish
