#include "score/image_quality.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "diminish/diminished_frame.h"

namespace diminish {

double psnr_db(double mean_squared_error) {
  constexpr double largest = 99;
  if (mean_squared_error <= 0) return largest;
  return std::min(largest, 10 * std::log10(255 * 255 / mean_squared_error));
}

SquaredError squared_error(const cv::Mat& picture, const cv::Mat& truth, const cv::Mat& region) {
  const double norm = cv::norm(picture, truth, cv::NORM_L2, region);
  return {norm * norm, static_cast<std::size_t>(cv::countNonZero(region)) * 3};
}

cv::Mat ssim_map(const cv::Mat& picture, const cv::Mat& truth) {
  constexpr double c1 = (0.01 * 255) * (0.01 * 255);
  constexpr double c2 = (0.03 * 255) * (0.03 * 255);
  cv::Mat a;
  cv::Mat b;
  cv::cvtColor(picture, a, cv::COLOR_BGR2GRAY);
  cv::cvtColor(truth, b, cv::COLOR_BGR2GRAY);
  a.convertTo(a, CV_64F);
  b.convertTo(b, CV_64F);
  const auto window = [](const cv::Mat& image) {
    cv::Mat result;
    cv::GaussianBlur(image, result, {11, 11}, 1.5, 1.5, cv::BORDER_REFLECT_101);
    return result;
  };
  const cv::Mat mean_a = window(a);
  const cv::Mat mean_b = window(b);
  const cv::Mat variance_a = window(a.mul(a)) - mean_a.mul(mean_a);
  const cv::Mat variance_b = window(b.mul(b)) - mean_b.mul(mean_b);
  const cv::Mat covariance = window(a.mul(b)) - mean_a.mul(mean_b);
  const cv::Mat numerator = cv::Mat(2 * mean_a.mul(mean_b) + c1).mul(cv::Mat(2 * covariance + c2));
  const cv::Mat denominator = cv::Mat(mean_a.mul(mean_a) + mean_b.mul(mean_b) + c1)
                                  .mul(cv::Mat(variance_a + variance_b + c2));
  return numerator / denominator;
}

std::optional<Quality> quality(const cv::Mat& picture, const cv::Mat& truth, const cv::Mat& ssim,
                               const cv::Mat& region) {
  const SquaredError error = squared_error(picture, truth, region);
  if (error.count == 0) return std::nullopt;
  return Quality{psnr_db(error.sum / static_cast<double>(error.count)), cv::mean(ssim, region)[0]};
}

cv::Mat grow(const cv::Mat& mask, int margin_px) {
  if (margin_px == 0) return mask;
  const cv::Size size(2 * margin_px + 1, 2 * margin_px + 1);
  cv::Mat disc(size, CV_8U);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int dx = x - margin_px;
      const int dy = y - margin_px;
      disc.at<std::uint8_t>(y, x) = dx * dx + dy * dy <= margin_px * margin_px ? 1 : 0;
    }
  }
  cv::Mat grown;
  cv::dilate(mask, grown, disc);
  return grown;
}

cv::Mat scored_region(const cv::Mat& true_mask, const cv::Mat& mask) {
  constexpr int margin_px = 3;
  return grow(true_mask.empty() ? mask : true_mask, margin_px);
}

cv::Mat seen_pixels(const cv::Mat& origin, const cv::Mat& mask) {
  if (origin.empty()) return cv::Mat::zeros(mask.size(), CV_8U);
  return (origin >= provenance::first_rgbd) & (origin < provenance::inpainted);
}

}  // namespace diminish
