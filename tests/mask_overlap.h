#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "core/mat.h"

namespace diminish {

inline Mask read_mask_image(const std::filesystem::path& file) {
  Mask mask;
  copy_from(cv::imread(file.string(), cv::IMREAD_GRAYSCALE), mask);
  return mask;
}

inline Image<Bgr> read_color_image(const std::filesystem::path& file) {
  Image<Bgr> image;
  copy_from(cv::imread(file.string(), cv::IMREAD_COLOR), image);
  return image;
}

inline double intersection_over_union(const Mask& a, const Mask& b) {
  std::size_t both = 0;
  std::size_t either = 0;
  EXPECT_EQ(a.bounds(), b.bounds());
  for (std::size_t i = 0; i < a.size(); ++i) {
    both += a.data()[i] != 0 && b.data()[i] != 0;
    either += a.data()[i] != 0 || b.data()[i] != 0;
  }
  return static_cast<double>(both) / static_cast<double>(either);
}

}  // namespace diminish
