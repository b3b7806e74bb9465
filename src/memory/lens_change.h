#pragma once

#include <opencv2/core.hpp>

#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// What a camera would show through another camera's lens, from the same place. Cost: 3 ns a
/// pixel, and 6 bytes of memory.
class LensChange {
 public:
  LensChange(const Intrinsics& from, const Intrinsics& to);

  /// picture: of the camera. shown: through the other lens; black beyond the camera's picture.
  void show(ImageView<Bgr> picture, Image<Bgr>& shown) const;
  /// objects: in the camera's picture. hidden: 255 where they would be, and beyond the picture.
  void hide(const Mask& objects, Mask& hidden) const;

 private:
  void look_up(const cv::Mat& picture, const cv::Scalar& beyond, const cv::Mat& shown) const;

  int width_, height_;      ///< of what is shown
  cv::Mat pixels_, parts_;  ///< fixed-point maps for cv::remap
};

}  // namespace diminish
