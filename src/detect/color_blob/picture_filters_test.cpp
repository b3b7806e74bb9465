#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/extremum_filters.h"
#include "core/mat.h"
#include "detect/color_blob/smooth_picture.h"
#include "each_vector_target.h"
#include "noise.h"

namespace diminish {
namespace {

template <class Pixel>
void expect_same(const Image<Pixel>& image, const cv::Mat& expected) {
  ASSERT_EQ(cv::Size(image.width(), image.height()), expected.size());
  EXPECT_EQ(cv::norm(as_mat(image), expected, cv::NORM_INF), 0);
}

TEST(PictureSmoother, IsOpenCvsGaussian) {
  const Image<Bgr> image = testing::noise(61, 37);
  cv::Mat expected;
  cv::GaussianBlur(as_mat(image), expected, {3, 3}, 0, 0, cv::BORDER_REPLICATE);
  PictureSmoother smoother;
  Image<Bgr> smooth(61, 37);
  for (int y = 0; y < 37; ++y) smoother.smooth_row(image, image.bounds(), y, 0, 61, smooth.row(y));
  expect_same(smooth, expected);
}

TEST(PictureSmoother, APartMayReachBeyondThePicture) {
  const Image<Bgr> image = testing::noise(30, 20);
  const Rect part{-5, 9, 40, 17};
  cv::Mat larger;
  cv::copyMakeBorder(as_mat(image), larger, 10, 10, 10, 10, cv::BORDER_REPLICATE);
  cv::GaussianBlur(larger, larger, {3, 3}, 0);
  PictureSmoother smoother;
  Image<Bgr> smooth(40 - 7, 17);
  for (int y = 0; y < 17; ++y) smoother.smooth_row(image, part, y, 3, 36, smooth.row(y));
  expect_same(smooth, larger(cv::Rect(part.x + 3 + 10, part.y + 10, 33, 17)));
}

TEST(ExtremumFilters, AreOpenCvs) {
  const Image<Bgr> image = testing::noise(45, 31);
  Mask mask;
  cv::Mat blue;
  cv::extractChannel(as_mat(image), blue, 0);
  copy_from(blue, mask);
  for (const Reach reach : {Reach{1, 1}, Reach{2, 2}, Reach{2, 1}, Reach{0, 2}, Reach{3, 0}}) {
    const cv::Mat kernel =
        cv::getStructuringElement(cv::MORPH_RECT, {2 * reach.x + 1, 2 * reach.y + 1});
    cv::Mat expected;
    Image<Bgr> colors, color_scratch;
    Mask values, scratch;
    cv::dilate(as_mat(image), expected, kernel);
    dilate(image, reach, color_scratch, colors);
    expect_same(colors, expected);
    cv::erode(as_mat(image), expected, kernel);
    erode(image, reach, color_scratch, colors);
    expect_same(colors, expected);
    cv::dilate(blue, expected, kernel);
    dilate(mask, reach, scratch, values);
    expect_same(values, expected);
    cv::erode(blue, expected, kernel);
    erode(mask, reach, scratch, values);
    expect_same(values, expected);
  }
}

TEST(ExtremumFilters, ReachBeyondASmallImage) {
  Mask mask(2, 3, 7);
  mask(1, 2) = 200;
  Mask result, scratch;
  dilate(mask, {4, 4}, scratch, result);
  EXPECT_EQ(result, Mask(2, 3, 200));
}

}  // namespace
}  // namespace diminish
