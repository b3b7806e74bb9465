#pragma once

#include <opencv2/imgproc.hpp>
#include <random>

#include "core/mat.h"

namespace diminish::testing {

/// Blots and single pixels, touching each other in every way, and the border.
inline Mask blots(unsigned seed) {
  std::mt19937 random(seed);
  cv::Mat drawn = cv::Mat::zeros(70, 90, CV_8U);
  for (int i = 0; i < 30; ++i) {
    const cv::Point center(static_cast<int>(random() % 90), static_cast<int>(random() % 70));
    const int radius = static_cast<int>(random() % 9);
    cv::circle(drawn, center, radius, i % 3 == 2 ? 0 : 255, i % 4 == 0 ? 1 : cv::FILLED);
  }
  Mask mask;
  copy_from(drawn, mask);
  return mask;
}

}  // namespace diminish::testing
