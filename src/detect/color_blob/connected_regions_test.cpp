#include "detect/color_blob/connected_regions.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "core/mat.h"

namespace diminish {
namespace {

/// Blots and single pixels, touching each other in every way, and the border.
Mask blots(unsigned seed) {
  std::mt19937 random(seed);
  cv::Mat drawn = cv::Mat::zeros(70, 90, CV_8U);
  for (int i = 0; i < 30; ++i) {
    const cv::Point center(static_cast<int>(random() % 90), static_cast<int>(random() % 70));
    const int radius = static_cast<int>(random() % 9);
    cv::circle(drawn, center, radius, i % 3 == 2 ? 0 : 255, i % 4 == 0 ? 1 : cv::FILLED);
  }
  Mask mask;
  copy_from(drawn, mask);
  return mask;
}

TEST(ConnectedRegions, AreOpenCvsComponents) {
  ConnectedRegions regions;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Mask mask = blots(seed);
    for (const std::uint8_t value : {std::uint8_t{255}, std::uint8_t{0}}) {
      for (const Connectivity connectivity : {Connectivity::four, Connectivity::eight}) {
        cv::Mat labels, statistics, centers;
        const int count =
            cv::connectedComponentsWithStats(as_mat(mask) == value, labels, statistics, centers,
                                             connectivity == Connectivity::four ? 4 : 8);
        regions.find(mask, value, connectivity);
        ASSERT_EQ(regions.regions().size() + 1, static_cast<std::size_t>(count));
        int pixels = 0;
        for (const ConnectedRegions::Run& run : regions.runs()) {
          const ConnectedRegions::Region& region = regions.regions()[run.region];
          const int label = labels.at<int>(region.first.y(), region.first.x());
          ASSERT_NE(label, 0);
          for (int x = run.first; x < run.last; ++x) EXPECT_EQ(labels.at<int>(run.y, x), label);
          pixels += run.last - run.first;
          const int* const expected = statistics.ptr<int>(label);
          EXPECT_EQ(region.box, (Rect{expected[cv::CC_STAT_LEFT], expected[cv::CC_STAT_TOP],
                                      expected[cv::CC_STAT_WIDTH], expected[cv::CC_STAT_HEIGHT]}));
          EXPECT_EQ(region.pixels, expected[cv::CC_STAT_AREA]);
        }
        EXPECT_EQ(pixels, cv::countNonZero(labels));
      }
    }
  }
}

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
    const Mask mask = blots(seed);
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
    regions.find(mask, 255, Connectivity::eight);
    for (const ConnectedRegions::Region& region : regions.regions()) {
      trace_outline(mask, region.first, outline);
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
