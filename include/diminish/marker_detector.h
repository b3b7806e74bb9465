#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diminish/export.h"
#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/poses.h"

namespace diminish {

/// Finds the square markers of one dictionary in an image.
class DIMINISH_EXPORT MarkerDetector {
 public:
  /// dictionary: OpenCV's name, such as DICT_4X4_50. Throws Error for an unknown one.
  explicit MarkerDetector(const std::string& dictionary);
  ~MarkerDetector();
  MarkerDetector(MarkerDetector&&) noexcept;
  MarkerDetector& operator=(MarkerDetector&&) noexcept;

  /// Finds the markers in `image`, sorted by id, with sub-pixel corners: each side is a line fitted
  /// to the image's edge, and neighbouring lines are intersected. A marker whose id appears twice
  /// is ambiguous and left out. lens: the camera's; sides are straight in its undistorted rays.
  void detect(ImageView<Bgr> image, const Lens& lens, std::vector<Marker>& markers);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
