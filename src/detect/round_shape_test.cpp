#include "detect/round_shape.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace diminish {
namespace {

std::optional<RoundShape> fit(const cv::Mat& region) {
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(region, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  return outlines.empty() ? std::nullopt : fit_round_shape(outlines[0], region);
}

cv::Mat picture_of(const RoundShape& shape) {
  cv::Mat region = cv::Mat::zeros(120, 160, CV_8U);
  shape.draw(region);
  return region;
}

TEST(RoundShape, DrawsThePixelsWhoseCentresAreInside) {
  const cv::Mat circle = picture_of({{80, 60}, {2.5, 2.5}});
  EXPECT_EQ(cv::countNonZero(circle), 21);
  const cv::Mat turned = picture_of({{80, 60}, {20, 0.5}, CV_PI / 2});
  EXPECT_EQ(cv::boundingRect(turned), cv::Rect(80, 40, 1, 41));
}

TEST(RoundShape, FindsAnEllipse) {
  const auto shape = fit(picture_of({{70.3, 55.8}, {40, 30}, 0.6}));
  ASSERT_TRUE(shape);
  EXPECT_TRUE(is_round(*shape));
  EXPECT_GT(shape->agreement, 0.97);
  EXPECT_NEAR(shape->center.x, 70.3, 0.2);
  EXPECT_NEAR(shape->center.y, 55.8, 0.2);
  EXPECT_NEAR(shape->diameter(), 70, 0.7);
}

TEST(RoundShape, FindsABallThatIsCutOff) {
  for (const cv::Point2d& center : {cv::Point2d(-10, 60), {150, 110}, {80, -20}}) {
    const auto shape = fit(picture_of({center, {40, 40}}));
    ASSERT_TRUE(shape);
    EXPECT_TRUE(is_round(*shape));
    EXPECT_NEAR(shape->center.x, center.x, 1);
    EXPECT_NEAR(shape->center.y, center.y, 1);
    EXPECT_NEAR(shape->half_axes.width, 40, 1);
  }
}

TEST(RoundShape, IgnoresADentAndABump) {
  cv::Mat region = picture_of({{80, 60}, {40, 40}});
  region(cv::Rect(110, 55, 20, 10)) = 0;
  region(cv::Rect(30, 50, 15, 12)) = 255;
  const auto shape = fit(region);
  ASSERT_TRUE(shape);
  EXPECT_TRUE(is_round(*shape));
  EXPECT_NEAR(shape->center.x, 80, 0.5);
  EXPECT_NEAR(shape->diameter(), 80, 1);
}

TEST(RoundShape, OtherShapesAreNotRound) {
  cv::Mat stripe = cv::Mat::zeros(120, 160, CV_8U);
  stripe(cv::Rect(20, 50, 100, 20)) = 255;
  cv::Mat corner = cv::Mat::zeros(120, 160, CV_8U);
  corner(cv::Rect(20, 20, 80, 80)) = 255;
  corner(cv::Rect(50, 50, 50, 50)) = 0;
  cv::Mat cut_stripe = cv::Mat::zeros(120, 160, CV_8U);
  cut_stripe(cv::Rect(0, 50, 100, 20)) = 255;
  cv::Mat square = cv::Mat::zeros(120, 160, CV_8U);
  square(cv::Rect(20, 20, 80, 80)) = 255;
  for (const cv::Mat& region : {stripe, corner, cut_stripe, square}) {
    const auto shape = fit(region);
    EXPECT_FALSE(shape && is_round(*shape)) << shape->agreement;
  }
  EXPECT_FALSE(fit(picture_of({{80, 60}, {1, 1}})));
  EXPECT_FALSE(fit(cv::Mat(120, 160, CV_8U, cv::Scalar(255))));
}

}  // namespace
}  // namespace diminish
