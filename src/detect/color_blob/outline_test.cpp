#include "detect/color_blob/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <random>
#include <utility>

#include "blots.h"
#include "core/connected_regions.h"
#include "core/mat.h"

namespace diminish {
namespace {

/// An outline's pixels, in an order that does not depend on where it begins or which way it leads.
std::vector<std::pair<int, int>> sorted(const Outline& outline) {
  std::vector<std::pair<int, int>> pixels;
  for (const Eigen::Vector2i& pixel : outline) pixels.emplace_back(pixel.x(), pixel.y());
  std::sort(pixels.begin(), pixels.end());
  return pixels;
}

TEST(TraceOutline, FollowsOpenCvsContours) {
  ConnectedRegions regions;
  Outline outline;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Mask mask = testing::blots(seed);
    std::vector<std::vector<cv::Point>> contours;
    std::vector<cv::Vec4i> hierarchy;
    cv::findContours(as_mat(mask), contours, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
    std::vector<std::vector<std::pair<int, int>>> expected, found;
    double expected_area = 0;
    double area = 0;
    for (std::size_t i = 0; i < contours.size(); ++i) {
      if (hierarchy[i][3] >= 0) continue;  // a hole
      Outline contour;
      for (const cv::Point& point : contours[i]) contour.emplace_back(point.x, point.y);
      expected.push_back(sorted(contour));
      expected_area += cv::contourArea(contours[i]);
    }
    regions.find(mask, Pixels::set, Connectivity::eight);
    for (const ConnectedRegions::Region& region : regions.regions()) {
      trace_outline(mask, regions.first_pixel(region), outline);
      found.push_back(sorted(outline));
      area += polygon_area(outline);
      for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
        EXPECT_EQ((outline[i + 1] - outline[i]).cwiseAbs().maxCoeff(), 1);
      }
    }
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    EXPECT_TRUE(found == expected) << "seed " << seed;
    EXPECT_EQ(area, expected_area);
  }
}

TEST(TraceOutline, OfASinglePixelIsThePixel) {
  Mask mask(3, 3, 0);
  mask(1, 1) = 255;
  Outline outline;
  trace_outline(mask, {1, 1}, outline);
  EXPECT_EQ(outline, Outline{Eigen::Vector2i(1, 1)});
}

}  // namespace
}  // namespace diminish
