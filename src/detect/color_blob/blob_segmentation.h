#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/connected_regions.h"
#include "detect/color_blob/smooth_picture.h"
#include "detect/color_blob/watershed.h"
#include "diminish/image.h"

namespace diminish {

/// A part of a picture divided into blobs of even colour by watershed, at a fraction of its
/// resolution. Keeps its memory from one picture to the next.
class BlobSegmentation {
 public:
  /// A segment pixel covers `scale` x `scale` image pixels; the last ones of a row or column may
  /// stand for up to `scale - 1` more.
  static int scale(ImageView<Bgr> image);

  /// Divides a part of the picture; window: in segment pixels.
  void segment(ImageView<Bgr> image, const Rect& window);

  /// Of the window: 1 .. blob_count() - 1, or 0 on the lines between blobs.
  const Image<std::uint32_t>& labels() const { return labels_; }
  int blob_count() const { return static_cast<int>(mean_bgr_.size()); }
  const Eigen::Vector3d& mean_bgr(int label) const { return mean_bgr_[label]; }

 private:
  void find_seeds();
  void average_colors();

  Image<Bgr> small_;
  std::vector<std::uint16_t> sums_;
  PictureSmoother smoother_;
  Image<Bgr> smooth_, lightest_, darkest_, picture_scratch_;
  Mask gradient_, lowest_, seeds_, scratch_;
  ConnectedRegions seed_regions_;
  Watershed watershed_;
  Image<std::uint32_t> labels_;
  std::vector<Eigen::Vector4i> color_sums_;  ///< blue, green, red, pixels
  std::vector<Eigen::Vector3d> mean_bgr_;
};

}  // namespace diminish
