#pragma once

#include <cstdint>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// Averages 3x3 pixels with the weights 1 2 1 in both directions (a Gaussian of 0.85 pixels),
/// rounded, like `cv::GaussianBlur` with a 3x3 kernel. Reuses its memory.
class PictureSmoother {
 public:
  /// Smooths columns [first, last) of row y of the picture's part `part`. The part may extend
  /// beyond the picture, whose border is then repeated. Coordinates are relative to the part.
  void smooth_row(ImageView<Bgr> picture, const Rect& part, int y, int first, int last,
                  Bgr* result);

 private:
  /// Columns [first, last) of a row of the picture; both may lie outside.
  const std::uint8_t* row(ImageView<Bgr> picture, int y, int first, int last,
                          std::vector<Bgr>& scratch);

  std::vector<Bgr> outside_[3];
  std::vector<std::uint16_t> sums_;
};

}  // namespace diminish
