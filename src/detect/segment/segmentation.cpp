#include "detect/segment/segmentation.h"

#include <opencv2/imgproc.hpp>

#include "core/mat.h"

namespace diminish {
namespace {

/// Networks that answer in logits are surer than they should be.
void bound(cv::Mat& margin) {
  for (int y = 0; y < margin.rows; ++y) {
    float* const row = margin.ptr<float>(y);
    for (int x = 0; x < margin.cols; ++x) row[x] /= 1 + std::abs(row[x]);
  }
}

bool add_object(const cv::Mat& margin, cv::Mat& enlarged, Mask& mask) {
  cv::resize(margin, enlarged, cv::Size(mask.width(), mask.height()), 0, 0, cv::INTER_LINEAR);
  bool any = false;
  for (int y = 0; y < mask.height(); ++y) {
    const auto* const row = enlarged.ptr<float>(y);
    std::uint8_t* const masked = mask.row(y);
    for (int x = 0; x < mask.width(); ++x) {
      if (!(row[x] > 0)) continue;
      masked[x] = 255;
      any = true;
    }
  }
  return any;
}

}  // namespace

Segmentation::Segmentation(const OnnxSettings& settings, const Config& place, cv::Size picture)
    : every_(settings.every),
      steady_(static_cast<float>(settings.steady)),
      network_(settings, place),
      pixels_(picture) {}

bool Segmentation::segment(ImageView<Bgr> picture, double stamp_s, Mask& mask) {
  if (every_ == 1 && steady_ == 0) {
    network_.find_margin(picture, answer_);
    return add_object(answer_, enlarged_, mask);
  }
  if (count_ > 0 && (stamp_s <= last_stamp_s_ || stamp_s > last_stamp_s_ + longest_s)) {
    begin_anew();
  }
  last_stamp_s_ = stamp_s;
  pixels_.follow(picture, carried_, {&shown_was_in_, &started_was_in_});
  if (count_ == 0 || every_ == 1) {
    if (count_ > 0) carry(started_with_);
    network_.find_margin(picture, answer_);
    take(answer_, count_ > 0 ? started_with_ : cv::Mat());
    pixels_.here().copyTo(shown_was_in_);
  } else if (count_ % every_ == 0) {
    if (running_.valid()) {
      take(running_.get(), started_with_);
      cv::swap(shown_was_in_, started_was_in_);
    }
    carry(started_with_);
    pixels_.here().copyTo(started_was_in_);
    copy(picture, started_);
    running_ = std::async(std::launch::async, [this] {
      cv::Mat answer;
      network_.find_margin(started_, answer);
      return answer;
    });
  }
  ++count_;
  carry(carried_);
  return add_object(carried_, enlarged_, mask);
}

void Segmentation::begin_anew() {
  if (running_.valid()) running_.wait();
  running_ = {};
  count_ = 0;
  pixels_.forget();
  carried_.release();
  shown_was_in_.release();
  started_was_in_.release();
}

void Segmentation::take(const cv::Mat& answer, const cv::Mat& shown_then) {
  cv::resize(answer, on_grid_, pixels_.grid(), 0, 0, cv::INTER_LINEAR);
  if (steady_ > 0) {
    bound(on_grid_);
    if (!shown_then.empty()) {
      cv::addWeighted(on_grid_, 1 - steady_, shown_then, steady_, 0, on_grid_);
    }
  }
  cv::swap(on_grid_, shown_);
}

void Segmentation::carry(cv::Mat& carried) {
  cv::remap(shown_, carried, shown_was_in_, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
}

}  // namespace diminish
