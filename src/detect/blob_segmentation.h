#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// A picture divided into blobs of even colour by watershed, at a fraction of its resolution.
/// Keeps its memory from one picture to the next.
class BlobSegmentation {
 public:
  void segment(const Image<Bgr>& image);

  /// A segment pixel covers `scale` x `scale` image pixels; the last ones of a row or column may
  /// stand for up to `scale - 1` more.
  int scale() const { return scale_; }
  /// CV_32S: 1 .. blob_count() - 1, or 0 on the lines between blobs.
  const cv::Mat& labels() const { return labels_; }
  int blob_count() const { return static_cast<int>(mean_bgr_.size()); }
  const Eigen::Vector3d& mean_bgr(int label) const { return mean_bgr_[label]; }

 private:
  void find_seeds();
  void average_colors();

  int scale_ = 1;
  cv::Mat small_, smooth_, lightest_, darkest_, gradient_, lowest_, seeds_, labels_;
  std::vector<cv::Mat> channels_;
  std::vector<Eigen::Vector3d> mean_bgr_;
  std::vector<int> areas_;
};

/// The object's outline at full resolution: the watershed of `image`'s colours between the inside
/// and the outside of `region` (255 on the object, one pixel per `scale` image pixels). Sets the
/// object's pixels in `mask`, which has the image's size, to 255.
void refine_region(const Image<Bgr>& image, const cv::Mat& region, int scale, Mask& mask);

}  // namespace diminish
