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

  /// The markers in `image`, by ascending id. Corners are sub-pixel: each side is a line fitted to
  /// the image's edge, each corner the meeting point of two. A marker whose id is in the image
  /// twice is ambiguous and left out. lens: the camera's, in whose undistorted rays sides are
  /// straight.
  void detect(const Image<Bgr>& image, const Lens& lens, std::vector<Marker>& markers);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
