#include "score/image_quality.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

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

}  // namespace diminish
