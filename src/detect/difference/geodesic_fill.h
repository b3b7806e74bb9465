#pragma once

#include <vector>

#include "detect/difference/object_evidence.h"
#include "diminish/image.h"

namespace diminish {

/// Gives each pixel that is not certain to what it is nearest to, scene or object, where a way
/// across an edge of the picture is long (geodesic segmentation: Criminisi, Sharp & Blake 2008).
class GeodesicFill {
 public:
  /// Fills in `shown` inside `part`. What is far from everything stays as it is. Cost: about 0.1 us
  /// for each pixel that is not certain.
  void fill(const Image<Bgr>& picture, const Rect& part, Image<Shown>& shown);

 private:
  struct Pixel {
    int x, y;
    bool is_unlike;
  };
  void improve(const Image<Bgr>& picture, const Pixel& pixel, int sign, Image<Shown>& shown);
  float& way_to(int x, int y) { return way_(x - part_.x + 1, y - part_.y + 1); }

  Rect part_;
  std::vector<Pixel> pixels_;  ///< that are not certain, row by row
  Image<float> way_;           ///< to each pixel, from what is certain; the part, a pixel larger
};

}  // namespace diminish
