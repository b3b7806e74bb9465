#include "detect/segment/depth_outline.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace diminish {

DepthOutline::DepthOutline(const RgbdCamera& camera)
    : rays_(RayTable::of(camera.depth)),
      places_(camera),
      unit_m_(static_cast<float>(camera.depth_unit_m)),
      color_px_(camera.color.fx / camera.depth.fx) {
  const auto pixels_across = [](double color, double depth) {
    constexpr double same = 0.95;  // of two focal lengths that differ by the lens only
    return std::max(1, static_cast<int>(std::ceil(color / depth * same)));
  };
  footprint_ = {pixels_across(camera.color.fx, camera.depth.fx),
                pixels_across(camera.color.fy, camera.depth.fy)};
  const cv::Size size(camera.depth.width, camera.depth.height);
  const auto pixels = static_cast<std::size_t>(size.area());
  columns_.resize(pixels);
  lines_.resize(pixels);
  depth_m_.create(size, CV_32F);
  in_mask_.create(size, CV_8U);
}

void DepthOutline::refine(ImageView<std::uint16_t> depth, float error_px, float threshold_m,
                          Mask& color) {
  look_up(depth, color);
  const int radius = std::max(1, static_cast<int>(std::ceil(error_px / color_px_)));
  kernel_ = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1});
  // Beside the mask: what is measured and not within reach of it. On it: what no outside reaches.
  cv::dilate(in_mask_, sure_, kernel_);
  cv::bitwise_not(sure_, sure_);
  cv::erode(in_mask_, core_, kernel_);
  if (cv::countNonZero(core_) == 0 || cv::countNonZero(sure_) == 0) return;
  spread(core_, core_m_);
  spread(sure_, rest_m_);
  for (int y = 0; y < depth_m_.rows; ++y) {
    for (int x = 0; x < depth_m_.cols; ++x) {
      const float z = depth_m_.at<float>(y, x);
      if (z == 0 || core_.at<std::uint8_t>(y, x) || sure_.at<std::uint8_t>(y, x)) continue;
      const float on = core_m_.at<float>(y, x);
      const float beside = rest_m_.at<float>(y, x);
      if (on == 0 || beside == 0 || std::abs(on - beside) < 2 * threshold_m) continue;
      const float to_object = std::abs(z - on);
      const float to_rest = std::abs(z - beside);
      if (std::min(to_object, to_rest) > threshold_m) continue;
      paint(x, y, to_object < to_rest ? 255 : 0, color);
    }
  }
}

void DepthOutline::look_up(ImageView<std::uint16_t> depth, const Mask& color) {
  const int width = depth.width();
  for (int y = 0; y < depth.height(); ++y) {
    const std::uint16_t* const values = depth.row(y);
    const float* const ray_x = rays_->x(y);
    const float* const ray_y = rays_->y(y);
    auto* const metres = depth_m_.ptr<float>(y);
    std::uint8_t* const masked = in_mask_.ptr(y);
    for (int x = 0; x < width; ++x) {
      metres[x] = static_cast<float>(values[x]) * unit_m_;
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x);
      ColorPlaces::Place place{-1, -1};
      if (values[x] != 0) place = places_.at(ray_x[x], ray_y[x], metres[x]);
      if (!place.exists()) metres[x] = 0;
      columns_[i] = place.column;
      lines_[i] = place.line;
      masked[x] = place.exists() ? color.row(place.line)[place.column] : 0;
    }
  }
}

void DepthOutline::spread(const cv::Mat& sources, cv::Mat& nearest_m) {
  cv::Mat missing(sources.size(), CV_8U);
  for (int y = 0; y < sources.rows; ++y) {
    for (int x = 0; x < sources.cols; ++x) {
      const bool is_source = sources.at<std::uint8_t>(y, x) && depth_m_.at<float>(y, x) > 0;
      missing.at<std::uint8_t>(y, x) = is_source ? 0 : 1;
    }
  }
  nearest_m.create(sources.size(), CV_32F);
  if (cv::countNonZero(missing) == static_cast<int>(missing.total())) {
    nearest_m.setTo(0);
    return;
  }
  cv::distanceTransform(missing, distance_, labels_, cv::DIST_L2, cv::DIST_MASK_5,
                        cv::DIST_LABEL_PIXEL);
  by_label_.assign(missing.total() + 1, 0);
  for (int y = 0; y < sources.rows; ++y) {
    for (int x = 0; x < sources.cols; ++x) {
      if (missing.at<std::uint8_t>(y, x)) continue;
      by_label_[static_cast<std::size_t>(labels_.at<int>(y, x))] = depth_m_.at<float>(y, x);
    }
  }
  for (int y = 0; y < sources.rows; ++y) {
    for (int x = 0; x < sources.cols; ++x) {
      nearest_m.at<float>(y, x) = by_label_[static_cast<std::size_t>(labels_.at<int>(y, x))];
    }
  }
}

void DepthOutline::paint(int x, int y, std::uint8_t value, Mask& color) const {
  const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(depth_m_.cols) +
                 static_cast<std::size_t>(x);
  const Rect footprint{columns_[i] - (footprint_.width - 1) / 2,
                       lines_[i] - (footprint_.height - 1) / 2, footprint_.width,
                       footprint_.height};
  color.fill(intersect(footprint, color.bounds()), value);
}

}  // namespace diminish
