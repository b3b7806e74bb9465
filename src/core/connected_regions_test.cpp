#include "core/connected_regions.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "blots.h"
#include "core/mat.h"

namespace diminish {
namespace {

/// Single pixels at random: at some densities parts are winding.
Mask noise(unsigned seed, unsigned percent) {
  std::mt19937 random(seed);
  Mask mask(90, 70);
  for (std::uint8_t& pixel : mask) pixel = random() % 100 < percent ? 255 : 0;
  return mask;
}

/// `regions` must be OpenCV's components of the pixels that are not 0.
void expect_components(const ConnectedRegions& regions, const cv::Mat& pixels,
                       Connectivity connectivity) {
  cv::Mat labels, statistics, centers;
  const int count = cv::connectedComponentsWithStats(pixels, labels, statistics, centers,
                                                     connectivity == Connectivity::four ? 4 : 8);
  ASSERT_EQ(regions.regions().size() + 1, static_cast<std::size_t>(count));
  int covered = 0;
  for (const ConnectedRegions::Region& region : regions.regions()) {
    const Eigen::Vector2i first = regions.first_pixel(region);
    const int label = labels.at<int>(first.y(), first.x());
    ASSERT_NE(label, 0);
    const int* const expected = statistics.ptr<int>(label);
    EXPECT_EQ(region.box, (Rect{expected[cv::CC_STAT_LEFT], expected[cv::CC_STAT_TOP],
                                expected[cv::CC_STAT_WIDTH], expected[cv::CC_STAT_HEIGHT]}));
    EXPECT_EQ(region.pixels, expected[cv::CC_STAT_AREA]);
    int in_region = 0;
    Eigen::Vector2i end(-1, first.y());  // of the run before
    regions.for_each_run(region, [&](const ConnectedRegions::Run& run) {
      EXPECT_EQ(&regions.regions()[static_cast<std::size_t>(run.region)], &region);
      EXPECT_TRUE(run.y > end.y() || (run.y == end.y() && run.first > end.x()));
      end = {run.last, run.y};
      for (int x = run.first; x < run.last; ++x) EXPECT_EQ(labels.at<int>(run.y, x), label);
      in_region += run.last - run.first;
    });
    EXPECT_EQ(in_region, region.pixels);
    covered += in_region;
  }
  EXPECT_EQ(covered, cv::countNonZero(labels));
}

TEST(ConnectedRegions, AreOpenCvsComponents) {
  std::vector<Mask> masks;
  for (unsigned seed = 0; seed < 20; ++seed) masks.push_back(testing::blots(seed));
  for (const unsigned percent : {0U, 30U, 55U, 62U, 80U, 100U}) masks.push_back(noise(7, percent));
  ConnectedRegions regions;  // its memory is used again
  for (const Mask& mask : masks) {
    for (const Pixels pixels : {Pixels::set, Pixels::clear}) {
      for (const Connectivity connectivity : {Connectivity::four, Connectivity::eight}) {
        regions.find(mask, pixels, connectivity);
        const cv::Mat set = as_mat(mask);
        expect_components(regions, pixels == Pixels::set ? set : cv::Mat(set == 0), connectivity);
      }
    }
  }
}

// Rows without a run, too, part what is above and below them.
TEST(ConnectedRegions, OfRunsThatAreGivenOneByOne) {
  for (const unsigned percent : {2U, 40U, 60U}) {
    Mask mask = noise(11, percent);
    for (const int y : {0, 17, 18, 40, 69}) mask.fill({0, y, mask.width(), 1}, 0);
    ConnectedRegions regions;
    regions.begin();
    for (int y = 0; y < mask.height(); ++y) {
      for (int x = 0; x < mask.width();) {
        const int first = x;
        while (x < mask.width() && mask(x, y) != 0) ++x;
        if (x > first) regions.add(y, first, x);
        if (x == first) ++x;
      }
    }
    regions.connect(Connectivity::four);
    expect_components(regions, as_mat(mask), Connectivity::four);
  }
}

}  // namespace
}  // namespace diminish
