#include "membrane/connected_runs.h"

#include <gtest/gtest.h>

#include <map>
#include <opencv2/imgproc.hpp>
#include <random>
#include <set>

namespace diminish {
namespace {

// Against OpenCV's connected components, at densities at which parts are winding.
TEST(ConnectedRuns, AreThePartsThatOpenCvFinds) {
  std::mt19937 random(1);
  for (const int percent : {0, 30, 55, 62, 80, 100}) {
    constexpr int words = 3;
    constexpr int stride = words + 2;
    constexpr int height = 45;
    cv::Mat set = cv::Mat::zeros(height, 32 * words, CV_8U);
    std::vector<std::uint32_t> bits(static_cast<std::size_t>(stride * height), 0);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < set.cols; ++x) {
        if (static_cast<int>(random() % 100) >= percent) continue;
        set.at<std::uint8_t>(y, x) = 255;
        bits[static_cast<std::size_t>(stride * y + x / 32)] |= 1U << (x % 32);
      }
    }
    cv::Mat labels;
    const int parts = cv::connectedComponents(set, labels, 4) - 1;
    ConnectedRuns runs;
    runs.find(bits.data(), stride, words, height);
    std::map<std::size_t, int> label_of_part;
    cv::Mat covered = cv::Mat::zeros(set.size(), CV_8U);
    for (int y = 0; y < height; ++y) {
      for (const ConnectedRuns::Run& run : runs.row(y)) {
        ASSERT_LT(run.part, runs.part_limit());
        for (int x = run.first; x < run.last; ++x) {
          const int label = labels.at<int>(y, x);
          const auto [known, is_new] = label_of_part.try_emplace(run.part, label);
          ASSERT_EQ(known->second, label);
          covered.at<std::uint8_t>(y, x) = 255;
        }
        for (int word = run.first / 32; word <= (run.last - 1) / 32; ++word) {
          for (int bit = 0; bit < 32; ++bit) {
            const int x = 32 * word + bit;
            const bool inside = x >= run.first && x < run.last;
            ASSERT_EQ((run.bits(word) >> bit & 1) != 0, inside) << x;
          }
        }
      }
    }
    EXPECT_EQ(cv::norm(covered, set, cv::NORM_INF), 0);
    std::set<int> labels_seen;
    for (const auto& [part, label] : label_of_part) labels_seen.insert(label);
    EXPECT_EQ(label_of_part.size(), static_cast<std::size_t>(parts));
    EXPECT_EQ(labels_seen.size(), static_cast<std::size_t>(parts));
  }
}

}  // namespace
}  // namespace diminish
