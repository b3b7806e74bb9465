#include "pose/corner_refinement.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/mat.h"
#include "diminish/error.h"
#include "diminish/marker_detector.h"
#include "pose/opencv_aruco.h"

namespace diminish {
namespace {

const Intrinsics ideal{640, 480, 600, 600, 320, 240, {}};

struct RenderedMarker {
  Image<Bgr> image;
  std::array<Eigen::Vector2d, 4> corners;
};

/// Marker `id` in perspective on a light ground, rendered with 8x8 samples a pixel, then blurred
/// and made noisy.
RenderedMarker render_marker(int id, const std::array<Eigen::Vector2d, 4>& corners, double blur,
                             double noise, unsigned seed) {
  constexpr int modules = 6;
  cv::Mat code;
  opencv_aruco::draw(opencv_aruco::dictionary(cv::aruco::DICT_4X4_50), id, modules, code);
  std::vector<cv::Point2f> from = {{0, 0}, {modules, 0}, {modules, modules}, {0, modules}};
  std::vector<cv::Point2f> to;
  to.reserve(corners.size());
  for (const Eigen::Vector2d& corner : corners) {
    to.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  }
  const cv::Matx33d code_from_image = cv::Mat(cv::getPerspectiveTransform(to, from));
  cv::Mat picture(ideal.height, ideal.width, CV_32F);
  constexpr int samples = 8;
  for (int y = 0; y < ideal.height; ++y) {
    for (int x = 0; x < ideal.width; ++x) {
      double sum = 0;
      for (int s = 0; s < samples * samples; ++s) {
        const int column = s % samples;
        const int row = s / samples;
        const cv::Vec3d p = code_from_image * cv::Vec3d(x + (column + 0.5) / samples - 0.5,
                                                        y + (row + 0.5) / samples - 0.5, 1);
        const double u = p[0] / p[2];
        const double v = p[1] / p[2];
        const bool inside = u >= 0 && u < modules && v >= 0 && v < modules;
        sum += inside ? 30 + 0.75 * code.at<std::uint8_t>(static_cast<int>(v), static_cast<int>(u))
                      : 225;
      }
      picture.at<float>(y, x) = static_cast<float>(sum / (samples * samples));
    }
  }
  cv::GaussianBlur(picture, picture, {}, blur);
  std::mt19937 random(seed);
  std::normal_distribution<float> gauss(0, static_cast<float>(noise));
  RenderedMarker result{Image<Bgr>(ideal.width, ideal.height), corners};
  for (int y = 0; y < ideal.height; ++y) {
    for (int x = 0; x < ideal.width; ++x) {
      const auto level = cv::saturate_cast<std::uint8_t>(picture.at<float>(y, x) + gauss(random));
      result.image(x, y) = {level, level, level};
    }
  }
  return result;
}

// Blur and noise as cameras have them; markers of 60 to 150 pixels in perspective.
TEST(MarkerDetector, CornersAreRightToATenthOfAPixel) {
  MarkerDetector detector("DICT_4X4_50");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-0.15, 0.15);
  double squares = 0;
  double worst = 0;
  int count = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const double size = 60 + 8 * trial;
    const Eigen::Vector2d origin(200.3 + trial, 120.7);
    std::array<Eigen::Vector2d, 4> corners = {origin, origin + Eigen::Vector2d(size, 0),
                                              origin + Eigen::Vector2d(size, size),
                                              origin + Eigen::Vector2d(0, size)};
    for (auto& corner : corners) corner += size * Eigen::Vector2d(jitter(random), jitter(random));
    const RenderedMarker rendered =
        render_marker(trial, corners, 0.6 + 0.06 * trial, 3, static_cast<unsigned>(trial));
    std::vector<Marker> markers;
    detector.detect(rendered.image, Lens(ideal), markers);
    ASSERT_EQ(markers.size(), 1U) << "trial " << trial;
    EXPECT_EQ(markers[0].id, trial);
    for (std::size_t c = 0; c < 4; ++c) {
      const double error = (markers[0].corners[c] - corners[c]).norm();
      squares += error * error / 2;
      worst = std::max(worst, error);
      ++count;
    }
  }
  RecordProperty("corner_rms_px", std::to_string(std::sqrt(squares / count)));
  EXPECT_LT(std::sqrt(squares / count), 0.10);
  EXPECT_LT(worst, 0.4);
}

TEST(MarkerDetector, AnIdThatIsThereTwiceIsLeftOut) {
  const auto square = [](double x, double y) {
    return std::array<Eigen::Vector2d, 4>{
        Eigen::Vector2d(x, y), {x + 80, y}, {x + 80, y + 80}, {x, y + 80}};
  };
  RenderedMarker first = render_marker(4, square(50, 50), 0.7, 1, 1);
  const RenderedMarker second = render_marker(4, square(300, 200), 0.7, 1, 2);
  for (int y = 180; y < 320; ++y) {
    std::copy_n(second.image.row(y) + 280, 200, first.image.row(y) + 280);
  }
  std::vector<Marker> markers;
  MarkerDetector detector("DICT_4X4_50");
  detector.detect(first.image, Lens(ideal), markers);
  EXPECT_TRUE(markers.empty());
  detector.detect(second.image, Lens(ideal), markers);
  EXPECT_EQ(markers.size(), 1U);
}

TEST(MarkerDetector, AnUnknownDictionaryIsAnError) {
  try {
    MarkerDetector detector("DICT_9X9");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("DICT_4X4_50"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("'DICT_9X9'"), std::string::npos);
  }
}

// Nothing to hold on to: the corners stay where they are.
TEST(RefineCorners, LeavesCornersAloneWhereThereIsNoEdge) {
  const Image<Bgr> flat(200, 200, {128, 128, 128});
  const std::array<Eigen::Vector2d, 4> corners = {
      Eigen::Vector2d(50, 50), {120, 52}, {118, 121}, {49, 119}};
  auto refined = corners;
  EXPECT_FALSE(refine_corners(flat, Lens(ideal), 6, fine_pass, refined));
  EXPECT_EQ(refined, corners);
}

}  // namespace
}  // namespace diminish
