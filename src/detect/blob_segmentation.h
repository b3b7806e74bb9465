#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// A part of a picture divided into blobs of even colour by watershed, at a fraction of its
/// resolution. Keeps its memory from one picture to the next.
class BlobSegmentation {
 public:
  /// Makes the picture small.
  void shrink(const Image<Bgr>& image);
  /// Divides a part of the small picture.
  void segment(const Rect& window);

  /// A segment pixel covers `scale` x `scale` image pixels; the last ones of a row or column may
  /// stand for up to `scale - 1` more.
  int scale() const { return scale_; }
  const Image<Bgr>& small_picture() const { return small_; }
  const Rect& window() const { return window_; }
  /// CV_32S, of the window: 1 .. blob_count() - 1, or 0 on the lines between blobs.
  const cv::Mat& labels() const { return labels_; }
  int blob_count() const { return static_cast<int>(mean_bgr_.size()); }
  const Eigen::Vector3d& mean_bgr(int label) const { return mean_bgr_[label]; }

 private:
  void find_seeds();
  void average_colors();

  int scale_ = 1;
  Image<Bgr> small_;
  Rect window_;
  std::vector<std::uint16_t> sums_;
  cv::Mat smooth_, lightest_, darkest_, gradient_, lowest_, seeds_, labels_;
  std::vector<cv::Mat> channels_;
  std::vector<Eigen::Vector3d> mean_bgr_;
  std::vector<int> areas_;
};

/// The object's outline at full resolution: the watershed of `image`'s colours between the inside
/// and the outside of `region` (255 on the object, one pixel per `scale` image pixels), which lies
/// in the small picture's `window`. Writes the object's pixels, 255, and the others around it, 0,
/// to `object`, and returns where that lies in the image; the object's border is inside unless it
/// is cut off by the image's.
Rect refine_region(const Image<Bgr>& image, const cv::Mat& region, const Rect& window, int scale,
                   Mask& object);

}  // namespace diminish
