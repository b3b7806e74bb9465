#include "score/viewer_figures.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "diminish/diminished_frame.h"
#include "score/image_quality.h"

namespace diminish {
namespace {

/// Fewer invented pixels than this say nothing.
constexpr int fewest_invented = 51;

/// The brightness, with what is finer than a viewer's eye taken away: CV_32F.
cv::Mat smooth_brightness(const cv::Mat& picture) {
  cv::Mat brightness;
  cv::cvtColor(picture, brightness, cv::COLOR_BGR2GRAY);
  brightness.convertTo(brightness, CV_32F);
  cv::GaussianBlur(brightness, brightness, {}, 1.0);
  return brightness;
}

cv::Mat edges_of(const cv::Mat& brightness) {
  // Whole levels, rounded down: Canny takes no others.
  cv::Mat levels(brightness.size(), CV_8U);
  levels.forEach<std::uint8_t>([&](std::uint8_t& level, const int* at) {
    level = static_cast<std::uint8_t>(brightness.at<float>(at[0], at[1]));
  });
  cv::Mat edges;
  cv::Canny(levels, edges, 30, 60);
  return edges;
}

/// Prewitt's gradient magnitude.
cv::Mat gradient_of(const cv::Mat& brightness) {
  const cv::Mat across = (cv::Mat_<double>(3, 3) << 1, 0, -1, 1, 0, -1, 1, 0, -1) / 3;
  cv::Mat x;
  cv::Mat y;
  cv::filter2D(brightness, x, -1, across);
  cv::filter2D(brightness, y, -1, across.t());
  cv::Mat magnitude;
  cv::magnitude(x, y, magnitude);
  return magnitude;
}

/// The share of `edges` that lies within 2 pixels of `others`, where `region` is not 0.
double share_near(const cv::Mat& edges, const cv::Mat& others, const cv::Mat& region) {
  cv::Mat near;
  cv::dilate(others, near, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  const int all = cv::countNonZero(edges & region);
  return static_cast<double>(cv::countNonZero(edges & near & region)) / std::max(1, all);
}

/// Xue et al. 2014.
double similarity_of(const cv::Mat& a, const cv::Mat& b, const cv::Mat& region) {
  constexpr double c = 170;
  const cv::Mat alike = cv::Mat(2 * a.mul(b) + c) / cv::Mat(cv::Mat(a.mul(a) + b.mul(b)) + c);
  return cv::mean(alike, region)[0];
}

/// Nothing where there are no pixels.
std::optional<double> sharpness(const cv::Mat& result, const cv::Mat& truth,
                                const cv::Mat& region) {
  if (cv::countNonZero(region) == 0) return std::nullopt;
  const double pixels = cv::countNonZero(region);
  return cv::mean(result, region)[0] / std::max(1e-6 / pixels, cv::mean(truth, region)[0]);
}

double f1(double recall, double precision) {
  return 2 * recall * precision / std::max(1e-9, recall + precision);
}

}  // namespace

std::optional<ViewerFigures> viewer_figures(const ViewerInput& input) {
  cv::Mat region;
  cv::dilate(input.mask, region, cv::Mat::ones(7, 7, CV_8U));
  const int pixels = cv::countNonZero(region);
  if (pixels == 0) return std::nullopt;
  const cv::Mat origin =
      input.provenance.empty() ? cv::Mat::zeros(region.size(), CV_8U) : input.provenance;
  const cv::Mat invented = region & (origin == provenance::inpainted);
  const cv::Mat seen = region & ~invented & (origin != provenance::camera);

  const cv::Mat truth = smooth_brightness(input.truth);
  const cv::Mat result = smooth_brightness(input.result);
  const cv::Mat true_edges = edges_of(truth);
  const cv::Mat edges = edges_of(result);
  const cv::Mat true_gradient = gradient_of(truth);
  const cv::Mat gradient = gradient_of(result);

  ViewerFigures figures;
  figures.edge_recall = share_near(true_edges, edges, region);
  figures.edge_precision = share_near(edges, true_edges, region);
  figures.edge_f1 = f1(figures.edge_recall, figures.edge_precision);
  figures.gradient_similarity = similarity_of(true_gradient, gradient, region);
  figures.sharpness_seen = sharpness(gradient, true_gradient, seen);
  const int invented_pixels = cv::countNonZero(invented);
  figures.invented_share = static_cast<double>(invented_pixels) / pixels;
  if (invented_pixels >= fewest_invented) {
    figures.sharpness_invented = sharpness(gradient, true_gradient, invented);
    figures.invented = quality(input.result, input.truth, input.ssim, invented);
  }
  return figures;
}

std::optional<ViewerFigures> mean_of(const std::vector<ViewerFigures>& frames) {
  if (frames.empty()) return std::nullopt;
  const auto mean = [&](auto&& figure) -> std::optional<double> {
    double sum = 0;
    int count = 0;
    for (const ViewerFigures& frame : frames) {
      if (const std::optional<double> value = figure(frame)) {
        sum += *value;
        ++count;
      }
    }
    return count > 0 ? std::optional(sum / count) : std::nullopt;
  };
  const auto mean_of_all = [&](double ViewerFigures::*member) {
    return *mean([&](const ViewerFigures& frame) { return std::optional(frame.*member); });
  };
  const auto mean_of_some = [&](std::optional<double> ViewerFigures::*member) {
    return mean([&](const ViewerFigures& frame) { return frame.*member; });
  };
  const auto mean_invented = [&](double Quality::*member) {
    return mean([&](const ViewerFigures& frame) {
      return frame.invented ? std::optional((*frame.invented).*member) : std::nullopt;
    });
  };
  ViewerFigures result;
  result.edge_recall = mean_of_all(&ViewerFigures::edge_recall);
  result.edge_precision = mean_of_all(&ViewerFigures::edge_precision);
  result.edge_f1 = f1(result.edge_recall, result.edge_precision);
  result.gradient_similarity = mean_of_all(&ViewerFigures::gradient_similarity);
  result.invented_share = mean_of_all(&ViewerFigures::invented_share);
  result.sharpness_seen = mean_of_some(&ViewerFigures::sharpness_seen);
  result.sharpness_invented = mean_of_some(&ViewerFigures::sharpness_invented);
  if (const auto psnr = mean_invented(&Quality::psnr_db)) {
    result.invented = Quality{*psnr, *mean_invented(&Quality::ssim)};
  }
  return result;
}

}  // namespace diminish
