#include "detect/segment/followed_pixels.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "core/mat.h"

namespace diminish {
namespace {

/// Of the grid: fine enough for the outlines that networks find. Motion is smoother than that.
constexpr int most_columns = 320;
constexpr int flow_shrinkage = 2;

/// Farneback's: motion up to about 60 pixels of the grid.
constexpr int levels = 4;
constexpr double level_scale = 0.5;
constexpr int window = 9;
constexpr int iterations = 3;
constexpr int neighbourhood = 5;
constexpr double neighbourhood_sigma = 1.1;

/// How far the object's motion reaches beyond it: in pixels of the flow.
constexpr double reach = 8;
/// Of a pixel of the background, against one of the object's outermost.
constexpr float background_weight = 1e-3F;

}  // namespace

FollowedPixels::FollowedPixels(cv::Size picture) {
  const double scale = std::min(1., double{most_columns} / std::max(1, picture.width));
  const auto side = [&](int length) {
    return std::max(2 * flow_shrinkage, static_cast<int>(std::lround(length * scale)));
  };
  grid_ = {side(picture.width), side(picture.height)};
  here_.create(grid_, CV_32FC2);
  for (int y = 0; y < grid_.height; ++y) {
    for (int x = 0; x < grid_.width; ++x) {
      here_.at<cv::Vec2f>(y, x) = {static_cast<float>(x), static_cast<float>(y)};
    }
  }
}

void FollowedPixels::follow(ImageView<Bgr> picture, const cv::Mat& object,
                            std::initializer_list<cv::Mat*> was_in) {
  cv::resize(as_mat(picture), color_, grid_ / flow_shrinkage, 0, 0, cv::INTER_AREA);
  cv::cvtColor(color_, now_, cv::COLOR_BGR2GRAY);
  if (!last_.empty()) {
    find_flow(object);
    // Where a pixel was is not known, but where the last picture's pixels went: one step back.
    cv::subtract(here_, flow_, from_);
    cv::remap(flow_, flow_from_, from_, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::subtract(here_, flow_from_, from_);
    for (cv::Mat* const map : was_in) {
      if (map->empty()) continue;
      cv::remap(*map, moved_, from_, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
      cv::swap(*map, moved_);
    }
  }
  cv::swap(now_, last_);
}

void FollowedPixels::find_flow(const cv::Mat& object) {
  cv::calcOpticalFlowFarneback(last_, now_, small_, level_scale, levels, window, iterations,
                               neighbourhood, neighbourhood_sigma, 0);
  if (!object.empty()) {
    // The flow at an outline is that of neither side: the deeper in the object, the surer.
    cv::resize(object, object_, small_.size(), 0, 0, cv::INTER_AREA);
    cv::compare(object_, 0, inside_, cv::CMP_GT);
    cv::distanceTransform(inside_, depth_in_object_, cv::DIST_L2, 3);
    weight_.create(small_.size(), CV_32FC1);
    for (int y = 0; y < small_.rows; ++y) {
      const auto* const depth = depth_in_object_.ptr<float>(y);
      auto* const weight = weight_.ptr<float>(y);
      auto* const motion = small_.ptr<cv::Vec2f>(y);
      for (int x = 0; x < small_.cols; ++x) {
        weight[x] = depth[x] * depth[x] + background_weight;
        motion[x] *= weight[x];
      }
    }
    cv::GaussianBlur(weight_, weight_, {}, reach);
    cv::GaussianBlur(small_, small_, {}, reach);
    for (int y = 0; y < small_.rows; ++y) {
      const auto* const weight = weight_.ptr<float>(y);
      auto* const motion = small_.ptr<cv::Vec2f>(y);
      for (int x = 0; x < small_.cols; ++x) motion[x] /= weight[x];
    }
  }
  cv::resize(small_, flow_, grid_, 0, 0, cv::INTER_LINEAR);
  flow_ *= flow_shrinkage;
}

}  // namespace diminish
