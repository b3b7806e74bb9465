#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "diminish/intrinsics.h"
#include "geometry/projection.h"

namespace diminish {
namespace {

const Intrinsics color{1280, 1024, 1131.4, 1130.7, 645.2, 507.8, {-0.11, 0.09, 0.0006, -0.0004, 0}};

const Intrinsics lenses[] = {
    color,
    {512, 424, 365.6, 365.6, 255.1, 206.3, {0.0893, -0.268, 0, 0, 0.089}},
    {1280,
     720,
     605.1,
     605.3,
     637.2,
     365.1,
     {0.46, -2.5, 0.0008, -0.0004, 1.45, 0.34, -2.33, 1.38},
     LensModel::rational},
    {640,
     480,
     300,
     301,
     322.7,
     236.1,
     {0.3, 0.1, 0.0006, -0.0004, 0.02, 0.55, 0.12, 0.03},
     LensModel::rational},
    {640, 480, 330.1, 330.3, 322.7, 241.1, {-0.008, 0.045, -0.043, 0.008}, LensModel::fisheye},
    {1280, 1024, 640, 641, 637, 514, {0.1, 0.03, 0.01, -0.002}, LensModel::fisheye}};

class AnyLens : public ::testing::TestWithParam<Intrinsics> {
 protected:
  /// Calls visit(pixel) for pixels all over the picture, corners included.
  template <class Visit>
  void for_pixels(const Visit& visit) const {
    constexpr int steps = 20;
    for (int row = 0; row <= steps; ++row) {
      for (int column = 0; column <= steps; ++column) {
        visit(Eigen::Vector2d((camera.width - 1.0) * column / steps,
                              (camera.height - 1.0) * row / steps));
      }
    }
  }

  const Intrinsics camera = GetParam();
  const Lens lens{camera};
};
INSTANTIATE_TEST_SUITE_P(Models, AnyLens, ::testing::ValuesIn(lenses), [](const auto& test) {
  return std::string(name_of(test.param.lens_model)) + std::to_string(test.index);
});

TEST_P(AnyLens, ProjectsAsOpenCvDoes) {
  const cv::Matx33d matrix(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const std::size_t count = coefficient_count(camera.lens_model);
  const std::vector<double> k(camera.distortion.begin(),
                              camera.distortion.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<cv::Point3d> points;
  for_pixels([&](const Eigen::Vector2d& pixel) {
    const Eigen::Vector3d point = 1.3 * lens.undistort(pixel).homogeneous();
    points.emplace_back(point.x(), point.y(), point.z());
  });
  std::vector<cv::Point2d> expected;
  if (camera.lens_model == LensModel::fisheye) {
    cv::fisheye::projectPoints(points, expected, cv::Vec3d(), cv::Vec3d(), matrix, k);
  } else {
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix, k, expected);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel = lens.project({points[i].x, points[i].y, points[i].z});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), expected[i].x, 1e-9);
    EXPECT_NEAR(pixel->y(), expected[i].y, 1e-9);
  }
}

TEST_P(AnyLens, UndistortInvertsDistortOverTheWholePicture) {
  EXPECT_TRUE(lens.covers_picture());
  for_pixels([&](const Eigen::Vector2d& pixel) {
    const Eigen::Vector2d ray = lens.undistort(pixel);
    const auto back = lens.distort(ray);
    ASSERT_TRUE(back);
    EXPECT_LT((*back - pixel).norm(), 1e-6);
    EXPECT_LT((lens.undistort(*back) - ray).norm(), 1e-9);
  });
}

TEST_P(AnyLens, InSinglePrecisionIsTheSame) {
  const Projection projection(lens);
  for_pixels([&](const Eigen::Vector2d& pixel) {
    const Eigen::Vector2f ray = lens.undistort(pixel).cast<float>();
    float u = 0;
    float v = 0;
    ASSERT_TRUE(projection.distort(ray.x(), ray.y(), u, v));
    EXPECT_NEAR(u, pixel.x(), 1e-3);
    EXPECT_NEAR(v, pixel.y(), 1e-3);
  });
}

TEST_P(AnyLens, PointsBehindTheCameraHaveNoPixel) {
  EXPECT_FALSE(lens.project({0, 0, -1}));
  EXPECT_FALSE(lens.project({0, 0, 0}));
  EXPECT_FALSE(lens.project({1, 0.2, -0.1}));
  EXPECT_FALSE(lens.project({1, 0.2, 1e-3}));
}

TEST_P(AnyLens, WithACoefficientThatIsNoNumberHasNoPixels) {
  for (std::size_t i = 0; i < coefficient_count(camera.lens_model); ++i) {
    for (const double wrong :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      Intrinsics broken = camera;
      broken.distortion[i] = wrong;
      EXPECT_FALSE(Lens(broken).distort({0.1, 0.1}));
      EXPECT_FALSE(Lens(broken).covers_picture());
    }
  }
}

TEST(Lens, EndsWhereTheModelFoldsBack) {
  // r (1 - 0.3 r^2) grows until r = 1.054 and then folds back into the picture.
  Intrinsics camera = color;
  camera.distortion = {-0.3, 0, 0, 0, 0};
  EXPECT_TRUE(Lens(camera).distort({1.05, 0}));
  EXPECT_FALSE(Lens(camera).distort({1.06, 0}));
  // r / (1 + r^2) grows until r = 1.
  camera.lens_model = LensModel::rational;
  camera.distortion = {0, 0, 0, 0, 0, 1, 0, 0};
  EXPECT_TRUE(Lens(camera).distort({0, 0.99}));
  EXPECT_FALSE(Lens(camera).distort({0, 1.01}));
  // r / (1 - r^2) grows up to its pole at r = 1, and on its other side again.
  camera.distortion = {0, 0, 0, 0, 0, -1, 0, 0};
  EXPECT_TRUE(Lens(camera).distort({0, 0.99}));
  EXPECT_FALSE(Lens(camera).distort({0, 1.01}));
  EXPECT_FALSE(Lens(camera).distort({0, 5}));
  // theta (1 - 0.3 theta^2) grows until theta = 1.054, r = 1.766.
  camera.lens_model = LensModel::fisheye;
  camera.distortion = {-0.3, 0, 0, 0};
  EXPECT_TRUE(Lens(camera).distort({1.75, 0}));
  EXPECT_FALSE(Lens(camera).distort({1.78, 0}));
}

TEST(Lens, OfAFisheyeHasNoRaysFrom85DegreesOn) {
  Intrinsics camera = color;
  camera.lens_model = LensModel::fisheye;
  camera.distortion = {};
  const Lens lens(camera);
  const double degree = std::acos(-1.0) / 180;
  EXPECT_TRUE(lens.distort({std::tan(84.9 * degree), 0}));
  EXPECT_FALSE(lens.distort({0, std::tan(85.1 * degree)}));
  // A pixel at 100 degrees.
  const Eigen::Vector2d beyond(camera.cx + camera.fx * 100 * degree, camera.cy);
  const auto back = lens.distort(lens.undistort(beyond));
  EXPECT_FALSE(back && (*back - beyond).norm() < 100);
}

}  // namespace
}  // namespace diminish
