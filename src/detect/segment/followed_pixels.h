#pragma once

#include <opencv2/core.hpp>

#include "diminish/image.h"

namespace diminish {

/// Follows an object's pixels from picture to picture, so that what was found in an earlier one can
/// be shown in the newest. Flow by Farneback, "Two-frame motion estimation based on polynomial
/// expansion" (2003), on a small picture; OpenCV's other dense flow, DIS, depends on the number of
/// threads. All pixels near the object move as the object does: what its motion uncovers was
/// nowhere in the picture before, so that the outline would smear. Cost: 3 ms a picture on one
/// core.
class FollowedPixels {
 public:
  /// Of a picture; sizes the grid.
  explicit FollowedPixels(cv::Size picture);

  /// Of the small picture that is followed, and of all matrices below.
  cv::Size grid() const { return grid_; }

  /// The next picture. `was_in`: for each pixel of the grid, where it was in an earlier picture:
  /// two floats. They are moved on from the last picture to this one; empty ones are left alone.
  /// object: the last picture's, where it is above 0; float. Empty: none is known.
  void follow(ImageView<Bgr> picture, const cv::Mat& object,
              std::initializer_list<cv::Mat*> was_in);
  /// The next picture is the first of a sequence.
  void forget() { last_.release(); }

  /// Every pixel where it is.
  const cv::Mat& here() const { return here_; }

 private:
  /// `flow_`, of the grid, from the last picture to this one.
  void find_flow(const cv::Mat& object);

  cv::Size grid_;
  cv::Mat here_;
  cv::Mat now_, last_;  ///< brightness
  cv::Mat color_, small_, object_, inside_, depth_in_object_, weight_, flow_;
  cv::Mat from_, flow_from_, moved_;
};

}  // namespace diminish
