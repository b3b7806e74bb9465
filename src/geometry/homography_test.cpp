#include "geometry/homography.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace diminish {
namespace {

TEST(Homography, IsOpenCvsPerspectiveTransform) {
  using Quad = std::array<Eigen::Vector2d, 4>;
  const Quad quads[] = {{Eigen::Vector2d(0, 0), {1, 0}, {1, 1}, {0, 1}},
                        {Eigen::Vector2d(10, 20), {210, 5}, {190, 160}, {-30, 120}},
                        {Eigen::Vector2d(5, 5), {6, 9}, {3, 8}, {4, 6}}};
  for (const Quad& quad : quads) {
    const std::array<cv::Point2f, 4> unit = {cv::Point2f(0, 0), {1, 0}, {1, 1}, {0, 1}};
    std::array<cv::Point2f, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) {
      corners[i] = {static_cast<float>(quad[i].x()), static_cast<float>(quad[i].y())};
    }
    const cv::Mat expected = cv::getPerspectiveTransform(unit.data(), corners.data());
    const Eigen::Matrix3d homography = homography_of_unit_square(quad);
    for (int i = 0; i < 9; ++i) {
      EXPECT_NEAR(homography(i / 3, i % 3), expected.at<double>(i / 3, i % 3), 1e-9) << i;
    }
  }
}

}  // namespace
}  // namespace diminish
