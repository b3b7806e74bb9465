#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/mat.h"
#include "core/shrink.h"
#include "diminish/marker_detector.h"
#include "paths.h"
#include "pose/dark_regions.h"
#include "pose/marker_code.h"
#include "pose/opencv_aruco.h"
#include "pose/quad_candidates.h"

namespace diminish {
namespace {

const Lens no_lens(Intrinsics{0, 0, 1000, 1000, 0, 0, {}});

/// A light picture with a dark polygon.
Image<Bgr> dark_polygon(const std::vector<cv::Point>& corners) {
  Image<Bgr> image(400, 320, {220, 220, 220});
  cv::Mat mat = as_mat(image);
  cv::fillConvexPoly(mat, corners, cv::Scalar(30, 30, 30), cv::LINE_AA);
  return image;
}

std::vector<Quad> candidates(const Image<Bgr>& image) {
  Image<std::uint8_t> small;
  shrink_green(image, small);
  DarkRegions dark;
  QuadCandidates quads;
  return quads.find(dark.find(small));
}

TEST(DarkRegions, AreTheFourConnectedPartsBelowTheLocalMean) {
  std::mt19937 random(2);
  Image<std::uint8_t> picture(97, 61);
  for (std::uint8_t& pixel : picture) pixel = static_cast<std::uint8_t>(random() % 200 + 20);
  cv::Mat mat = as_mat(picture);
  cv::GaussianBlur(mat, mat, {}, 1.5);
  Mask expected(97, 61, 0);
  for (int y = 2; y < mat.rows - 2; ++y) {
    for (int x = 2; x < mat.cols - 2; ++x) {
      const double mean = cv::mean(mat(cv::Rect(x - 2, y - 2, 5, 5)))[0];
      // 27 (v + 2) < 25 mean
      if (27L * (picture(x, y) + 2) < std::lround(25 * mean)) expected(x, y) = 255;
    }
  }
  DarkRegions regions;
  Mask dark(97, 61, 0);
  const ConnectedRegions& found = regions.find(picture);
  for (const ConnectedRegions::Run& run : found.runs()) {
    dark.fill({run.first, run.y, run.last - run.first, 1}, 255);
  }
  EXPECT_TRUE(dark == expected);
  cv::Mat labels;
  const int count = cv::connectedComponents(as_mat(expected), labels, 4) - 1;
  ASSERT_GT(count, 20);
  EXPECT_EQ(found.regions().size(), static_cast<std::size_t>(count));
}

TEST(QuadCandidates, HaveTheCornersOfADarkQuadrilateral) {
  const std::vector<cv::Point> corners = {{90, 60}, {240, 85}, {215, 230}, {70, 190}};
  const std::vector<Quad> quads = candidates(dark_polygon(corners));
  ASSERT_EQ(quads.size(), 1U);
  for (const cv::Point& corner : corners) {
    const Eigen::Vector2d wanted(corner.x, corner.y);
    double nearest = 1e9;
    for (const Eigen::Vector2d& found : quads[0])
      nearest = std::min(nearest, (found - wanted).norm());
    EXPECT_LT(nearest, 8) << corner;
  }
  double doubled_area = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& a = quads[0][i];
    const Eigen::Vector2d& b = quads[0][(i + 1) % 4];
    doubled_area += a.x() * b.y() - a.y() * b.x();
  }
  EXPECT_GT(doubled_area, 0) << "clockwise with y down";
}

TEST(QuadCandidates, AreNotDiscsOrTriangles) {
  Image<Bgr> disc(400, 320, {220, 220, 220});
  cv::Mat mat = as_mat(disc);
  cv::circle(mat, {180, 150}, 80, cv::Scalar(30, 30, 30), cv::FILLED, cv::LINE_AA);
  EXPECT_TRUE(candidates(disc).empty());
  EXPECT_TRUE(candidates(dark_polygon({{60, 60}, {300, 90}, {150, 280}})).empty());
}

// Every id of a dictionary, from every side, in OpenCV's own drawing.
TEST(MarkerCode, ReadsWhatOpenCvDraws) {
  const auto dictionary = opencv_aruco::dictionary(cv::aruco::DICT_5X5_50);
  const MarkerCode code(find_dictionary("DICT_5X5_50"));
  const double first = 19.5;
  const double last = 89.5;
  const std::array<Eigen::Vector2d, 4> square = {
      Eigen::Vector2d(first, first), {last, first}, {last, last}, {first, last}};
  for (int id = 0; id < 50; ++id) {
    cv::Mat drawn;
    opencv_aruco::draw(dictionary, id, 70, drawn);
    Image<Bgr> image(110, 110, {255, 255, 255});
    for (int y = 0; y < 70; ++y) {
      for (int x = 0; x < 70; ++x) {
        const std::uint8_t level = drawn.at<std::uint8_t>(y, x);
        image(20 + x, 20 + y) = {level, level, level};
      }
    }
    for (int turn = 0; turn < 4; ++turn) {
      auto corners = square;
      std::rotate(corners.begin(), corners.begin() + turn, corners.end());
      const auto reading = code.read(image, corners);
      ASSERT_TRUE(reading) << id << ' ' << turn;
      EXPECT_EQ(reading->id, id);
      EXPECT_EQ((turn + reading->top_left) % 4, 0);
    }
    // Mirrored it is no marker.
    EXPECT_FALSE(code.read(image, {square[1], square[0], square[3], square[2]})) << id;
  }
}

TEST(MarkerDetector, FindsNothingInNoiseAndInTinyPictures) {
  MarkerDetector detector("DICT_4X4_50");
  std::vector<Marker> markers;
  std::mt19937 random(5);
  Image<Bgr> noise(640, 480);
  for (Bgr& pixel : noise) {
    pixel = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
             static_cast<std::uint8_t>(random())};
  }
  detector.detect(noise, no_lens, markers);
  EXPECT_TRUE(markers.empty());
  for (const auto& [width, height] : {std::pair(0, 0), std::pair(1, 1), std::pair(3, 2),
                                      std::pair(4, 4), std::pair(19, 400), std::pair(400, 19)}) {
    detector.detect(Image<Bgr>(width, height, {40, 40, 40}), no_lens, markers);
    EXPECT_TRUE(markers.empty());
  }
}

class MarkersOfRecordings : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Recordings, MarkersOfRecordings,
                         ::testing::Values("calendar/color", "calendar/rgbd0/color", "ball/color",
                                           "workbench/color", "workbench/rgbd0/color",
                                           "workbench/rgbd1/color"));

// Whatever OpenCV finds, we find, at the same place, which is some pixels off with OpenCV where a
// marker is small and slanted.
TEST_P(MarkersOfRecordings, AreThoseThatOpenCvFinds) {
  const auto dictionary = opencv_aruco::dictionary(cv::aruco::DICT_4X4_50);
  MarkerDetector detector("DICT_4X4_50");
  int found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(testing::recordings_dir()) / GetParam())) {
    const cv::Mat picture = cv::imread(entry.path().string());
    if (picture.empty()) continue;
    opencv_aruco::Corners corners;
    std::vector<int> ids;
    opencv_aruco::detect(picture, dictionary, true, corners, ids);
    Image<Bgr> image;
    copy_from(picture, image);
    std::vector<Marker> markers;
    detector.detect(image, no_lens, markers);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const auto ours = std::find_if(markers.begin(), markers.end(),
                                     [&](const Marker& marker) { return marker.id == ids[i]; });
      ASSERT_NE(ours, markers.end()) << entry.path() << ": " << ids[i];
      for (std::size_t c = 0; c < 4; ++c) {
        EXPECT_LT(std::hypot(ours->corners[c].x() - double{corners[i][c].x},
                             ours->corners[c].y() - double{corners[i][c].y}),
                  6);
      }
      ++found;
    }
    for (const Marker& marker : markers) EXPECT_LT(marker.id, 4) << "the scenes have no others";
  }
  EXPECT_GT(found, 0);
}

}  // namespace
}  // namespace diminish
