#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "diminish/score.h"

namespace diminish {

/// 10 log10(255^2 / mean squared error), at most 99.
double psnr_db(double mean_squared_error);

/// The squared error of 8-bit BGR pictures over the pixels where `region` is not 0.
struct SquaredError {
  double sum = 0;
  std::size_t count = 0;  ///< of pixels times channels
};
SquaredError squared_error(const cv::Mat& picture, const cv::Mat& truth, const cv::Mat& region);

/// Structural similarity of the brightness at every pixel: CV_64F.
cv::Mat ssim_map(const cv::Mat& picture, const cv::Mat& truth);

/// Nothing for an empty region. ssim: of the whole picture.
std::optional<Quality> quality(const cv::Mat& picture, const cv::Mat& truth, const cv::Mat& ssim,
                               const cv::Mat& region);

/// `mask`, grown by a disc.
cv::Mat grow(const cv::Mat& mask, int margin_px);
/// Where errors count: the true mask, or without one the run's, grown by 3 pixels.
cv::Mat scored_region(const cv::Mat& true_mask, const cv::Mat& mask);
/// 255 where an RGB-D camera saw the pixel. origin: provenance values; empty: nowhere.
cv::Mat seen_pixels(const cv::Mat& origin, const cv::Mat& mask);

}  // namespace diminish
