#include "detect/color_blob/outline_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/mat.h"
#include "mask_overlap.h"

namespace diminish {
namespace {

constexpr int object_label = 1;
constexpr int background_label = 2;

cv::Mat square(int size) {
  return cv::getStructuringElement(cv::MORPH_RECT, {size, size});
}

/// The side of the watershed's line that a pixel of the line is most similar to.
int nearest_side(const cv::Mat& colors, const cv::Mat& labels, int x, int y) {
  int side = object_label;
  double smallest = std::numeric_limits<double>::max();
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int label = labels.at<int>(y + dy, x + dx);
      if (label != object_label && label != background_label) continue;
      const double distance = cv::norm(colors.at<cv::Vec3b>(y, x),
                                       colors.at<cv::Vec3b>(y + dy, x + dx), cv::NORM_L2SQR);
      if (distance >= smallest) continue;
      smallest = distance;
      side = label;
    }
  }
  return side;
}

/// The plain version: the whole picture, by OpenCV.
Mask refine_plainly(const Image<Bgr>& image, const Mask& region, const Rect& window, int scale) {
  constexpr int rim = 3;
  cv::Mat coarse;
  cv::copyMakeBorder(as_mat(region), coarse, rim, rim, rim, rim, cv::BORDER_REPLICATE);
  cv::Mat inside, not_outside, fine_inside, fine_not_outside;
  cv::erode(coarse, inside, square(3));
  cv::dilate(coarse, not_outside, square(5));
  cv::resize(inside, fine_inside, {}, scale, scale, cv::INTER_NEAREST);
  cv::resize(not_outside, fine_not_outside, {}, scale, scale, cv::INTER_NEAREST);
  cv::Mat labels(fine_inside.size(), CV_32S, cv::Scalar(0));
  labels.setTo(background_label, fine_not_outside == 0);
  labels.setTo(object_label, fine_inside != 0);

  const cv::Point origin((window.x - rim) * scale, (window.y - rim) * scale);
  cv::Mat colors;
  constexpr int border = 100;
  cv::copyMakeBorder(as_mat(image), colors, border, border, border, border, cv::BORDER_REPLICATE);
  colors = colors(cv::Rect(origin + cv::Point(border, border), labels.size())).clone();
  cv::GaussianBlur(colors, colors, {3, 3}, 0);
  cv::watershed(colors, labels);

  Mask object(image.width(), image.height(), 0);
  for (int y = 1; y + 1 < labels.rows; ++y) {
    for (int x = 1; x + 1 < labels.cols; ++x) {
      int side = labels.at<int>(y, x);
      if (side == -1) side = nearest_side(colors, labels, x, y);
      if (side != object_label || !object.bounds().contains(origin.x + x, origin.y + y)) continue;
      object(origin.x + x, origin.y + y) = 255;
    }
  }
  return object;
}

/// A noisy disc on a noisy slope, and the cells of its region: a disc of another radius.
struct DiscPicture {
  DiscPicture(const cv::Point& center, int radius, int scale, int off_cells)
      : window{2, 1, 36, 30} {
    std::mt19937 random(11);
    cv::Mat drawn(40 * scale, 50 * scale, CV_8UC3);
    cv::Mat truth_mat = cv::Mat::zeros(drawn.size(), CV_8U);
    cv::circle(truth_mat, center, radius, 255, cv::FILLED);
    for (int y = 0; y < drawn.rows; ++y) {
      for (int x = 0; x < drawn.cols; ++x) {
        const int level = truth_mat.at<std::uint8_t>(y, x) != 0 ? 60 : 0;
        const auto value = [&](int base) {
          return static_cast<std::uint8_t>(base + static_cast<int>(random() % 15));
        };
        drawn.at<cv::Vec3b>(y, x) = {value(70 + x / scale), value(80 + level), value(100 - level)};
      }
    }
    copy_from(drawn, image);
    copy_from(truth_mat, truth);
    region.resize(window.width, window.height, 0);
    cv::Mat cells = as_mat(region);
    cv::circle(cells, {center.x / scale - window.x, center.y / scale - window.y},
               radius / scale + off_cells, 255, cv::FILLED);
  }

  Rect window;
  Image<Bgr> image;
  Mask truth, region;
};

Mask refine(const DiscPicture& picture, int scale) {
  OutlineRefinement refinement;
  Mask object;
  const Rect part = refinement.refine(picture.image, picture.region, picture.window, scale, object);
  EXPECT_EQ(object.bounds(), (Rect{0, 0, part.width, part.height}));
  Mask whole(picture.image.width(), picture.image.height(), 0);
  as_mat(object).copyTo(as_mat(whole)(as_cv(part)));
  return whole;
}

TEST(OutlineRefinement, IsThePlainOne) {
  for (const int scale : {1, 3, 4}) {
    for (const int off_cells : {-1, 0, 1}) {
      const DiscPicture picture({20 * scale, 17 * scale}, 9 * scale, scale, off_cells);
      const Mask refined = refine(picture, scale);
      EXPECT_EQ(refined, refine_plainly(picture.image, picture.region, picture.window, scale));
      if (scale > 1 && off_cells == 0) {
        EXPECT_GT(intersection_over_union(refined, picture.truth), 0.97);
      }
    }
  }
}

TEST(OutlineRefinement, AnObjectIsCutOffByThePicturesBorder) {
  constexpr int scale = 4;
  DiscPicture picture({2 * scale, 12 * scale}, 9 * scale, scale, 0);
  picture.window.x = picture.window.y = 0;
  picture.region.fill(0);
  cv::Mat cells = as_mat(picture.region);
  cv::circle(cells, {2, 12}, 9, 255, cv::FILLED);
  const Mask refined = refine(picture, scale);
  EXPECT_EQ(refined, refine_plainly(picture.image, picture.region, picture.window, scale));
  EXPECT_EQ(refined(0, 12 * scale), 255);
  EXPECT_GT(intersection_over_union(refined, picture.truth), 0.97);
}

TEST(OutlineRefinement, OfNothingIsNothing) {
  Mask object;
  EXPECT_TRUE(OutlineRefinement()
                  .refine(Image<Bgr>(20, 20), Mask(5, 5, 0), {0, 0, 5, 5}, 4, object)
                  .empty());
}

}  // namespace
}  // namespace diminish
