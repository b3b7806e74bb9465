#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "diminish/intrinsics.h"

namespace diminish {
namespace {

const Intrinsics kinect_depth{512, 424, 365.6, 365.6, 255.1, 206.3, {0.0893, -0.268, 0, 0, 0.089}};
const Intrinsics color{1280, 1024, 1131.4, 1130.7, 645.2, 507.8, {-0.11, 0.09, 0.0006, -0.0004, 0}};

TEST(Lens, ProjectsAsOpenCvDoes) {
  const Lens lens(color);
  const auto& k = color;
  const cv::Matx33d camera_matrix(k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1);
  const std::vector<double> distortion(k.distortion.begin(), k.distortion.end());
  const std::vector<cv::Point3d> points = {
      {0, 0, 1}, {0.3, -0.2, 1.2}, {-0.5, 0.4, 1}, {0.1, 0.9, 2}};
  std::vector<cv::Point2d> expected;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), camera_matrix, distortion, expected);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel = lens.project({points[i].x, points[i].y, points[i].z});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), expected[i].x, 1e-9);
    EXPECT_NEAR(pixel->y(), expected[i].y, 1e-9);
  }
}

TEST(Lens, UndistortInvertsDistortOverTheWholeImage) {
  for (const Intrinsics& intrinsics : {kinect_depth, color}) {
    const Lens lens(intrinsics);
    for (int y = 0; y < intrinsics.height; y += 53) {
      for (int x = 0; x < intrinsics.width; x += 73) {
        const auto pixel = lens.distort(lens.undistort(Eigen::Vector2d(x, y)));
        ASSERT_TRUE(pixel);
        EXPECT_NEAR(pixel->x(), x, 1e-6);
        EXPECT_NEAR(pixel->y(), y, 1e-6);
      }
    }
  }
}

TEST(Lens, PointsBehindTheCameraOrBeyondTheLensHaveNoPixel) {
  EXPECT_FALSE(Lens(color).project({0, 0, -1}));
  EXPECT_FALSE(Lens(color).project({0, 0, 0}));
  // r (1 - 0.3 r^2) grows until r = 1.054 and then folds back into the picture.
  Intrinsics barrel = color;
  barrel.distortion = {-0.3, 0, 0, 0, 0};
  EXPECT_TRUE(Lens(barrel).distort({1.0, 0}));
  EXPECT_FALSE(Lens(barrel).distort({1.1, 0}));
}

}  // namespace
}  // namespace diminish
