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

void BlobSegmentation::shrink(const Image<Bgr>& image) {
  scale_ = (image.width() + segment_width - 1) / segment_width;
  small_.resize(std::max(1, image.width() / scale_), std::max(1, image.height() / scale_));
  const int rows = std::min(scale_, image.height());
  const int columns = std::min(scale_, image.width());
  const auto used =
      static_cast<std::size_t>(small_.width()) * static_cast<std::size_t>(columns) * 3;
  const auto area = static_cast<unsigned>(rows * columns);
  // A multiplication is quicker than a division, and the same for values as small as these.
  const std::uint64_t reciprocal = (std::uint64_t{1} << 32) / area + 1;
  sums_.resize(used);
  for (int y = 0; y < small_.height(); ++y) {
    std::fill(sums_.begin(), sums_.end(), std::uint16_t{0});
    for (int dy = 0; dy < rows; ++dy) {
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(image.row(y * scale_ + dy));
      for (std::size_t i = 0; i < used; ++i)
        sums_[i] = static_cast<std::uint16_t>(sums_[i] + bytes[i]);
    }
    const std::uint16_t* sum = sums_.data();
    for (int x = 0; x < small_.width(); ++x) {
      unsigned blue = area / 2;
      unsigned green = area / 2;
      unsigned red = area / 2;
      for (int dx = 0; dx < columns; ++dx, sum += 3) {
        blue += sum[0];
        green += sum[1];
        red += sum[2];
      }
      const auto divided = [&](unsigned value) {
        return static_cast<std::uint8_t>((std::uint64_t{value} * reciprocal) >> 32);
      };
      small_(x, y) = {divided(blue), divided(green), divided(red)};
    }
  }
}

void BlobSegmentation::segment(const Rect& window) {
  window_ = window;
  const cv::Rect part(window.x, window.y, window.width, window.height);
  cv::GaussianBlur(as_mat(small_)(part), smooth_, {3, 3}, 0, 0,
                   cv::BORDER_DEFAULT | cv::BORDER_ISOLATED);
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
    const Bgr* const color = small_.row(window_.y + y) + window_.x;
    for (int x = 0; x < labels_.cols; ++x) {
      label[x] = std::max(label[x], 0);  // the lines between blobs are -1
      mean_bgr_[label[x]] += Eigen::Vector3d(color[x].b, color[x].g, color[x].r);
      ++areas_[label[x]];
    }
  }
  for (std::size_t i = 0; i < mean_bgr_.size(); ++i) mean_bgr_[i] /= std::max(areas_[i], 1);
}

Rect refine_region(const Image<Bgr>& image, const cv::Mat& region, const Rect& window, int scale,
                   Mask& object_mask) {
  // How far, in segment pixels, the outline may be inside and outside the region's.
  constexpr int inward = 1;
  constexpr int outward = 2;
  // The crop's own rim is outside, and cv::watershed gives no label to the outermost pixels.
  constexpr int rim = outward + 1;
  const cv::Rect box = cv::boundingRect(region);
  if (box.empty()) return {};
  // Beyond the picture's border both go on as they are at the border, so that an object that is
  // cut off there is not closed.
  cv::Mat coarse;
  cv::copyMakeBorder(region(box), coarse, rim, rim, rim, rim, cv::BORDER_REPLICATE);
  cv::Mat inside;
  cv::Mat not_outside;
  cv::erode(coarse, inside, square(2 * inward + 1));
  cv::dilate(coarse, not_outside, square(2 * outward + 1));

  const Rect part{(window.x + box.x - rim) * scale, (window.y + box.y - rim) * scale,
                  coarse.cols * scale, coarse.rows * scale};
  const Rect visible = intersect(part, image.bounds());
  cv::Mat colors;
  const cv::Rect crop(visible.x, visible.y, visible.width, visible.height);
  cv::copyMakeBorder(as_mat(image)(crop), colors, visible.y - part.y,
                     part.bottom() - visible.bottom(), visible.x - part.x,
                     part.right() - visible.right(), cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
  cv::Mat labels(part.height, part.width, CV_32S);
  for (int y = 0; y < part.height; ++y) {
    int* const label = labels.ptr<int>(y);
    if (y % scale != 0) {
      std::copy_n(labels.ptr<int>(y - 1), part.width, label);
      continue;
    }
    for (int x = 0; x < coarse.cols; ++x) {
      const int not_object = not_outside.at<std::uint8_t>(y / scale, x) != 0 ? 0 : background;
      const int value = inside.at<std::uint8_t>(y / scale, x) != 0 ? object : not_object;
      std::fill_n(label + std::ptrdiff_t{x} * scale, scale, value);
    }
  }
  cv::GaussianBlur(colors, colors, {3, 3}, 0);
  cv::watershed(colors, labels);

  object_mask.resize(visible.width, visible.height);
  for (int y = visible.y; y < visible.bottom(); ++y) {
    const int* const label = labels.ptr<int>(y - part.y) - part.x;
    std::uint8_t* const mask = object_mask.row(y - visible.y) - visible.x;
    const bool outermost_row = y == part.y || y == part.bottom() - 1;
    for (int x = visible.x; x < visible.right(); ++x) {
      int side = label[x];
      if (side == -1) {
        const bool outermost = outermost_row || x == part.x || x == part.right() - 1;
        side = outermost ? background : nearest_side(colors, labels, x - part.x, y - part.y);
      }
      mask[x] = side == object ? 255 : 0;
    }
  }
  return visible;
}

}  // namespace diminish
