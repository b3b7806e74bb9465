#pragma once

#include <opencv2/core.hpp>

#include "diminish/image.h"
#include "diminish/input_image.h"

namespace diminish {

template <class Pixel>
struct MatType;
template <>
struct MatType<std::uint8_t> {
  static constexpr int value = CV_8UC1;
};
template <>
struct MatType<std::uint16_t> {
  static constexpr int value = CV_16UC1;
};
template <>
struct MatType<float> {
  static constexpr int value = CV_32FC1;
};
template <>
struct MatType<Bgr> {
  static constexpr int value = CV_8UC3;
};
template <>
struct MatType<Bgra> {
  static constexpr int value = CV_8UC4;
};

/// The image's pixels as OpenCV sees them: a header, no copy.
template <class Pixel>
cv::Mat as_mat(Image<Pixel>& image) {
  return {image.height(), image.width(), MatType<Pixel>::value, image.data()};
}
/// The same, read-only. OpenCV has no read-only header; the caller must not write to it.
template <class Pixel>
cv::Mat as_mat(const ImageView<Pixel>& image) {
  return {image.height(), image.width(), MatType<Pixel>::value, const_cast<Pixel*>(image.data()),
          static_cast<std::size_t>(image.stride())};
}
template <class Pixel>
cv::Mat as_mat(const Image<Pixel>& image) {
  return as_mat(ImageView<Pixel>(image));
}
template <class Pixel>
cv::Mat as_mat(const InputImage<Pixel>& image) {
  return as_mat(image.view());
}

inline cv::Rect as_cv(const Rect& rect) {
  return {rect.x, rect.y, rect.width, rect.height};
}

/// Copies a matrix of the same pixel type.
template <class Pixel>
void copy_from(const cv::Mat& mat, Image<Pixel>& image) {
  CV_Assert(mat.type() == MatType<Pixel>::value);
  image.resize(mat.cols, mat.rows);
  mat.copyTo(as_mat(image));
}

}  // namespace diminish
