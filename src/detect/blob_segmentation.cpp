#include "detect/blob_segmentation.h"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/mat.h"

namespace diminish {
namespace {

/// The size of the picture that is divided: enough for blobs of a few pixels, small enough to be
/// quick and to average the noise.
constexpr int segment_width = 480;

constexpr int object = 1;
constexpr int background = 2;

/// On which side of the watershed's line a pixel of the line belongs: the one with the neighbour
/// of the most similar colour.
int nearest_side(const cv::Mat& colors, const cv::Mat& labels, int x, int y) {
  int side = object;
  int smallest = std::numeric_limits<int>::max();
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int label = labels.at<int>(y + dy, x + dx);
      if (label != object && label != background) continue;
      const cv::Vec3i difference =
          cv::Vec3i(colors.at<cv::Vec3b>(y, x)) - cv::Vec3i(colors.at<cv::Vec3b>(y + dy, x + dx));
      const int distance = difference.dot(difference);
      if (distance >= smallest) continue;
      smallest = distance;
      side = label;
    }
  }
  return side;
}

cv::Mat square(int size) {
  return cv::getStructuringElement(cv::MORPH_RECT, {size, size});
}

}  // namespace

void BlobSegmentation::segment(const Image<Bgr>& image) {
  scale_ = (image.width() + segment_width - 1) / segment_width;
  const cv::Size size(std::max(1, image.width() / scale_), std::max(1, image.height() / scale_));
  const cv::Mat whole_cells =
      as_mat(image)(cv::Rect({}, size * scale_) & cv::Rect(0, 0, image.width(), image.height()));
  cv::resize(whole_cells, small_, size, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(small_, smooth_, {3, 3}, 0);
  find_seeds();
  cv::watershed(smooth_, labels_);
  average_colors();
}

/// Each blob grows from a place where the colour changes least: `labels_` becomes the numbers of
/// the gradient magnitude's minima, all of them being one where they touch, and 0 elsewhere.
void BlobSegmentation::find_seeds() {
  cv::dilate(smooth_, lightest_, square(3));
  cv::erode(smooth_, darkest_, square(3));
  cv::subtract(lightest_, darkest_, gradient_);
  cv::split(gradient_, channels_);
  cv::max(channels_[0], channels_[1], gradient_);
  cv::max(gradient_, channels_[2], gradient_);

  // What changes less than this, in 8-bit levels, is even; noise has minima everywhere.
  constexpr double even = 6;
  cv::erode(gradient_, lowest_, square(5));
  cv::max(lowest_, even, lowest_);
  cv::compare(gradient_, lowest_, seeds_, cv::CMP_LE);
  cv::connectedComponents(seeds_, labels_, 4, CV_32S);
}

void BlobSegmentation::average_colors() {
  double largest = 0;
  cv::minMaxLoc(labels_, nullptr, &largest);
  mean_bgr_.assign(static_cast<std::size_t>(largest) + 1, Eigen::Vector3d::Zero());
  areas_.assign(mean_bgr_.size(), 0);
  for (int y = 0; y < labels_.rows; ++y) {
    int* const label = labels_.ptr<int>(y);
    const cv::Vec3b* const color = small_.ptr<cv::Vec3b>(y);
    for (int x = 0; x < labels_.cols; ++x) {
      label[x] = std::max(label[x], 0);  // the lines between blobs are -1
      mean_bgr_[label[x]] += Eigen::Vector3d(color[x][0], color[x][1], color[x][2]);
      ++areas_[label[x]];
    }
  }
  for (std::size_t i = 0; i < mean_bgr_.size(); ++i) mean_bgr_[i] /= std::max(areas_[i], 1);
}

void refine_region(const Image<Bgr>& image, const cv::Mat& region, int scale, Mask& mask) {
  // How far, in segment pixels, the outline may be inside and outside the region's.
  constexpr int inward = 1;
  constexpr int outward = 2;
  // The crop's own rim is outside, and cv::watershed gives no label to the outermost pixels.
  constexpr int rim = outward + 1;
  const cv::Rect box = cv::boundingRect(region);
  if (box.empty()) return;
  const cv::Rect cells(box.x - rim, box.y - rim, box.width + 2 * rim, box.height + 2 * rim);

  // Beyond the picture's border both go on as they are at the border, so that an object that is
  // cut off there is not closed.
  const auto repeated = [&](const auto* from, int x, int y, int width, int height) {
    return from[std::clamp(y, 0, height - 1) * static_cast<std::ptrdiff_t>(width) +
                std::clamp(x, 0, width - 1)];
  };
  cv::Mat coarse(cells.size(), CV_8U);
  for (int y = 0; y < coarse.rows; ++y) {
    for (int x = 0; x < coarse.cols; ++x) {
      coarse.at<std::uint8_t>(y, x) =
          repeated(region.ptr<std::uint8_t>(), x + cells.x, y + cells.y, region.cols, region.rows);
    }
  }
  cv::Mat inside;
  cv::Mat not_outside;
  cv::erode(coarse, inside, square(2 * inward + 1));
  cv::dilate(coarse, not_outside, square(2 * outward + 1));

  const Rect part{cells.x * scale, cells.y * scale, cells.width * scale, cells.height * scale};
  cv::Mat colors(part.height, part.width, CV_8UC3);
  cv::Mat labels(part.height, part.width, CV_32S);
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      const Bgr color =
          repeated(image.data(), x + part.x, y + part.y, image.width(), image.height());
      colors.at<cv::Vec3b>(y, x) = {color.b, color.g, color.r};
      const int cell_x = x / scale;
      const int cell_y = y / scale;
      int& label = labels.at<int>(y, x);
      if (inside.at<std::uint8_t>(cell_y, cell_x)) {
        label = object;
      } else {
        label = not_outside.at<std::uint8_t>(cell_y, cell_x) ? 0 : background;
      }
    }
  }
  cv::GaussianBlur(colors, colors, {3, 3}, 0);
  cv::watershed(colors, labels);

  const Rect visible = intersect(grow(part, -1), image.bounds());
  for (int y = visible.y; y < visible.bottom(); ++y) {
    for (int x = visible.x; x < visible.right(); ++x) {
      int label = labels.at<int>(y - part.y, x - part.x);
      if (label == -1) label = nearest_side(colors, labels, x - part.x, y - part.y);
      if (label == object) mask(x, y) = 255;
    }
  }
}

}  // namespace diminish
