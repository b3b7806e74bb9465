#include "detect/color_blob/round_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "core/connected_regions.h"

namespace diminish {
namespace {

/// The only region's shape; the region's mask is the whole picture.
std::optional<RoundShape> fit(const Mask& region) {
  ConnectedRegions regions;
  regions.find(region, Pixels::set, Connectivity::eight);
  Outline outline;
  trace_outline(region, regions.first_pixel(regions.regions().at(0)), outline);
  return RoundShapeFitter().fit(outline, region, region.bounds());
}

Mask picture_of(const Ellipse& ellipse) {
  Mask region(160, 120, 0);
  draw(ellipse, region);
  return region;
}

TEST(RoundShape, DrawsThePixelsWhoseCentresAreInside) {
  const Mask circle = picture_of({{80, 60}, {2.5, 2.5}});
  EXPECT_EQ(count_nonzero(circle, circle.bounds()), 21U);
  const Mask turned = picture_of({{80, 60}, {20, 0.5}, std::numbers::pi / 2});
  EXPECT_EQ(bounding_box(turned), (Rect{80, 40, 1, 41}));
  const Ellipse ellipse{{70.3, 110.8}, {40, 30}, 0.6};  // cut off below
  const Mask drawn = picture_of(ellipse);
  for (int y = 0; y < drawn.height(); ++y) {
    for (int x = 0; x < drawn.width(); ++x) {
      const Eigen::Vector2d on_axes =
          Eigen::Rotation2Dd(-ellipse.angle_rad) * (Eigen::Vector2d(x, y) - ellipse.center);
      const bool inside = on_axes.cwiseQuotient(ellipse.half_axes).norm() <= 1;
      ASSERT_EQ(drawn(x, y), inside ? 255 : 0) << x << ' ' << y;
    }
  }
}

TEST(RoundShape, FindsAnEllipse) {
  const auto shape = fit(picture_of({{70.3, 55.8}, {40, 30}, 0.6}));
  ASSERT_TRUE(shape);
  EXPECT_TRUE(is_round(*shape));
  EXPECT_GT(shape->agreement, 0.97);
  EXPECT_NEAR(shape->ellipse.center.x(), 70.3, 0.2);
  EXPECT_NEAR(shape->ellipse.center.y(), 55.8, 0.2);
  EXPECT_NEAR(shape->diameter(), 70, 0.7);
}

TEST(RoundShape, FindsABallThatIsCutOff) {
  for (const Eigen::Vector2d& center : {Eigen::Vector2d(-10, 60), {150, 110}, {80, -20}}) {
    const auto shape = fit(picture_of({center, {40, 40}}));
    ASSERT_TRUE(shape);
    EXPECT_TRUE(is_round(*shape));
    EXPECT_NEAR(shape->ellipse.center.x(), center.x(), 1);
    EXPECT_NEAR(shape->ellipse.center.y(), center.y(), 1);
    EXPECT_NEAR(shape->ellipse.half_axes[0], 40, 1);
  }
}

/// The region's mask may be a part of the picture: what is outside of it is not the region.
TEST(RoundShape, TheMaskMayBeAPartOfThePicture) {
  const Mask whole = picture_of({{-10, 60}, {40, 40}});
  Mask part(35, 90, 0);  // of the picture from (0, 15) on
  for (int y = 0; y < 90; ++y) std::copy_n(whole.row(15 + y), 35, part.row(y));
  Outline outline;
  ConnectedRegions regions;
  regions.find(part, Pixels::set, Connectivity::eight);
  trace_outline(part, regions.first_pixel(regions.regions().at(0)), outline);
  const auto shape = RoundShapeFitter().fit(outline, part, {0, -15, 160, 120});
  const auto expected = fit(whole);
  ASSERT_TRUE(shape && expected);
  EXPECT_NEAR(shape->ellipse.center.x(), expected->ellipse.center.x(), 1e-6);
  EXPECT_NEAR(shape->ellipse.center.y() + 15, expected->ellipse.center.y(), 1e-6);
  EXPECT_NEAR(shape->ellipse.half_axes[0], expected->ellipse.half_axes[0], 1e-6);
  EXPECT_NEAR(shape->agreement, expected->agreement, 1e-3);
}

TEST(RoundShape, IgnoresADentAndABump) {
  Mask region = picture_of({{80, 60}, {40, 40}});
  region.fill({110, 55, 20, 10}, 0);
  region.fill({30, 50, 15, 12}, 255);
  const auto shape = fit(region);
  ASSERT_TRUE(shape);
  EXPECT_TRUE(is_round(*shape));
  EXPECT_NEAR(shape->ellipse.center.x(), 80, 0.5);
  EXPECT_NEAR(shape->diameter(), 80, 1);
}

TEST(RoundShape, OtherShapesAreNotRound) {
  const auto picture_of_rectangle = [](const Rect& rectangle) {
    Mask region(160, 120, 0);
    region.fill(rectangle, 255);
    return region;
  };
  const Mask stripe = picture_of_rectangle({20, 50, 100, 20});
  const Mask cut_stripe = picture_of_rectangle({0, 50, 100, 20});
  const Mask square = picture_of_rectangle({20, 20, 80, 80});
  Mask corner = square;
  corner.fill({50, 50, 50, 50}, 0);
  for (const Mask& region : {stripe, corner, cut_stripe, square}) {
    const auto shape = fit(region);
    EXPECT_FALSE(shape && is_round(*shape)) << shape->agreement;
  }
  EXPECT_FALSE(fit(picture_of({{80, 60}, {1, 1}})));
  EXPECT_FALSE(fit(Mask(160, 120, 255)));
}

}  // namespace
}  // namespace diminish
