#include "score/error_budget.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "score/image_quality.h"

namespace diminish {
namespace {

enum Cause { of_mask, of_missing, of_pose, of_edges, of_color, of_texture };

constexpr int largest_shift_px = 4;
constexpr int edge_reach_px = 4;
/// Standard deviation of the neighbourhood.
constexpr double neighbourhood_px = 6;

cv::Mat to_levels(const cv::Mat& picture) {
  cv::Mat levels;
  picture.convertTo(levels, CV_64FC3);
  return levels;
}

/// Summed over the channels.
cv::Mat squares_of(const cv::Mat& difference) {
  cv::Mat channels[3];
  cv::split(difference, channels);
  return channels[0].mul(channels[0]) + channels[1].mul(channels[1]) + channels[2].mul(channels[2]);
}

cv::Mat moved(const cv::Mat& picture, int dx, int dy) {
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, dx, 0, 1, dy);
  cv::Mat result;
  cv::warpAffine(picture, result, move, picture.size(), cv::INTER_NEAREST, cv::BORDER_REPLICATE);
  return result;
}

double sum_where(const cv::Mat& values, const cv::Mat& mask) {
  return cv::mean(values, mask).val[0] * cv::countNonZero(mask);
}

/// result - truth after the shift that leaves the least of it on `seen` pixels.
cv::Mat best_shifted(const cv::Mat& result, const cv::Mat& truth, const cv::Mat& seen) {
  cv::Mat best = result - truth;
  double least = sum_where(squares_of(best), seen);
  for (int dy = -largest_shift_px; dy <= largest_shift_px; ++dy) {
    for (int dx = -largest_shift_px; dx <= largest_shift_px; ++dx) {
      const cv::Mat difference = moved(result, dx, dy) - truth;
      const double sum = sum_where(squares_of(difference), seen);
      if (sum >= least) continue;
      least = sum;
      best = difference;
    }
  }
  return best;
}

/// Within reach of an edge of the truth, or of where what was seen ends.
cv::Mat near_edges(const cv::Mat& truth, const cv::Mat& seen) {
  cv::Mat smooth;
  cv::GaussianBlur(truth, smooth, {5, 5}, 1.2);
  cv::Mat edges;
  cv::Canny(smooth, edges, 30, 80);
  cv::Mat eroded;
  cv::erode(seen, eroded, {}, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(255));
  return grow(edges | (seen & ~eroded), edge_reach_px);
}

/// The mean of `difference` around each pixel, over the pixels in `mask`.
cv::Mat mean_around(const cv::Mat& difference, const cv::Mat& mask) {
  cv::Mat weights;
  mask.convertTo(weights, CV_64F, 1.0 / 255);
  cv::Mat weights3;
  cv::merge(std::vector<cv::Mat>(3, weights), weights3);
  cv::Mat sum;
  cv::Mat total;
  cv::GaussianBlur(difference.mul(weights3), sum, {}, neighbourhood_px);
  cv::GaussianBlur(weights3, total, {}, neighbourhood_px);
  cv::Mat mean;
  cv::divide(sum, cv::max(total, 1e-6), mean);
  return mean;
}

/// The region, with room for what shifts and averages read.
cv::Rect surroundings(const cv::Mat& region) {
  constexpr int margin = 24;
  const cv::Rect box = cv::boundingRect(region);
  return cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
         cv::Rect({}, region.size());
}

}  // namespace

ErrorCauses find_error_causes(const ErrorInput& whole) {
  const cv::Size size = whole.result.size();
  const cv::Rect part = surroundings(whole.region);
  const ErrorInput input{whole.result(part), whole.truth(part), whole.region(part),
                         whole.mask(part), whole.seen(part)};
  const cv::Mat result = to_levels(input.result);
  const cv::Mat truth = to_levels(input.truth);
  const cv::Mat squares = squares_of(result - truth);
  const cv::Mat seen = input.region & input.mask & input.seen;
  const cv::Mat shifted = best_shifted(result, truth, seen);
  const cv::Mat left = squares_of(shifted);
  const cv::Mat edges = near_edges(input.truth, input.mask & input.seen);
  const cv::Mat inside = seen & ~edges;
  cv::Mat color;
  cv::min(left, squares_of(mean_around(shifted, inside)), color);

  ErrorCauses causes;
  for (cv::Mat& picture : causes.squares) picture = cv::Mat::zeros(size, CV_64F);
  const auto lay = [&](const cv::Mat& errors, Cause cause, const cv::Mat& where) {
    errors.copyTo(causes.squares[cause](part), where);
  };
  lay(squares, of_mask, input.region & ~input.mask);
  lay(squares, of_missing, input.region & input.mask & ~input.seen);
  lay(squares - left, of_pose, seen);
  lay(left, of_edges, seen & edges);
  lay(color, of_color, inside);
  lay(left - color, of_texture, inside);

  ErrorBudget budget;
  double all = 0;
  for (std::size_t i = 0; i < budget.size(); ++i) {
    budget[i] = cv::sum(causes.squares[i]).val[0];
    all += budget[i];
  }
  if (all > 0) {
    for (double& share : budget) share /= all;
    causes.budget = budget;
  }
  return causes;
}

cv::Mat draw_error_causes(const ErrorCauses& causes) {
  // In the order of error_causes.
  const cv::Vec3d palette[] = {{255, 255, 255}, {230, 60, 230}, {80, 220, 80},
                               {40, 200, 255},  {255, 140, 40}, {150, 150, 150}};
  const cv::Size size = causes.squares[0].size();
  cv::Mat picture(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      std::size_t greatest = 0;
      double all = 0;
      for (std::size_t i = 0; i < causes.squares.size(); ++i) {
        all += causes.squares[i].at<double>(y, x);
        if (causes.squares[i].at<double>(y, x) > causes.squares[greatest].at<double>(y, x)) {
          greatest = i;
        }
      }
      constexpr double bright_levels = 60;
      const double share = std::min(1.0, std::sqrt(std::max(0.0, all) / 3) / bright_levels);
      picture.at<cv::Vec3b>(y, x) = palette[greatest] * share;
    }
  }
  return picture;
}

}  // namespace diminish
