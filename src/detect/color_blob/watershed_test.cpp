#include "detect/color_blob/watershed.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "core/mat.h"

namespace diminish {
namespace {

/// Slopes, steps and noise: colour differences of all sizes, many of them equal.
Image<Bgr> picture(int width, int height, unsigned seed) {
  Image<Bgr> image(width, height);
  std::mt19937 random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const unsigned step = (x / 13 + y / 9) % 3 == 0 ? 90 : 0;
      const auto value = [&](unsigned slope) {
        return static_cast<std::uint8_t>((step + slope + random() % 12) % 256);
      };
      image(x, y) = {value(x), value(y / 2), value(x / 3)};
    }
  }
  return image;
}

template <class Label>
void expect_opencvs_labels(int width, int height, unsigned basins, unsigned seed) {
  const Image<Bgr> colors = picture(width, height, seed);
  std::mt19937 random(seed + 1);
  Image<Label> labels(width, height, 0);
  for (unsigned basin = 1; basin <= basins; ++basin) {
    const Rect seeds =
        intersect({static_cast<int>(random() % width), static_cast<int>(random() % height),
                   static_cast<int>(1 + random() % 7), static_cast<int>(1 + random() % 7)},
                  labels.bounds());
    labels.fill(seeds, static_cast<Label>(basin));
  }
  cv::Mat expected(height, width, CV_32S);
  std::copy(labels.begin(), labels.end(), expected.begin<int>());
  cv::watershed(as_mat(colors), expected);

  Watershed watershed;
  watershed.flood(colors, labels);
  std::vector<int> line;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int label = labels(x, y) == WatershedLabel<Label>::line ? -1 : labels(x, y);
      ASSERT_EQ(label, expected.at<int>(y, x)) << x << ' ' << y;
      const bool outermost = x == 0 || y == 0 || x == width - 1 || y == height - 1;
      if (label == -1 && !outermost) line.push_back(y * width + x);
    }
  }
  std::vector<int> reported = watershed.line();
  std::sort(reported.begin(), reported.end());
  EXPECT_EQ(reported, line);
}

TEST(Watershed, HasOpenCvsLabels) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    expect_opencvs_labels<std::uint32_t>(97, 71, 300, seed);
    expect_opencvs_labels<std::uint8_t>(97, 71, 40, seed);
    expect_opencvs_labels<std::uint8_t>(60, 90, 2, seed);
  }
  expect_opencvs_labels<std::uint8_t>(3, 3, 1, 0);
}

TEST(Watershed, WithoutSeedsNothingIsLabelled) {
  Image<std::uint8_t> labels(8, 6, 0);
  Watershed().flood(picture(8, 6, 0), labels);
  EXPECT_EQ(labels(3, 3), 0);
}

}  // namespace
}  // namespace diminish
