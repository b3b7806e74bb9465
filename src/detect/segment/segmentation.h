#pragma once

#include <future>

#include "detect/segment/followed_pixels.h"
#include "detect/segment/segmentation_network.h"

namespace diminish {

/// What a network finds in one camera's pictures. It may run in every n-th picture only, in a
/// thread of its own: each answer is shown n pictures after the one that it belongs to, carried
/// there and on by the pixels' motion. When an answer is taken depends on the pictures' number
/// only, not on the network's speed: same pictures, same masks. A network that needs longer than n
/// pictures is waited for.
class Segmentation {
 public:
  /// picture: of the camera. Throws Error that names the file.
  Segmentation(const OnnxSettings& settings, const Config& place, cv::Size picture);

  /// Sets the object's pixels to 255; returns whether there are any. The pictures of a camera come
  /// in their order; after a time that goes back, or a pause of more than `longest_s`, all begins
  /// anew. Throws Error.
  bool segment(ImageView<Bgr> picture, double stamp_s, Mask& mask);

  static constexpr double longest_s = 0.5;

 private:
  void begin_anew();
  /// An answer, on the grid, mixed with what was shown then.
  void take(const cv::Mat& answer, const cv::Mat& shown_then);
  /// Of what is shown, in the newest picture.
  void carry(cv::Mat& carried);

  int every_;
  float steady_;
  SegmentationNetwork network_;
  FollowedPixels pixels_;
  double last_stamp_s_ = 0;
  int count_ = 0;  ///< of pictures since it began
  cv::Mat answer_, on_grid_, shown_, enlarged_;
  cv::Mat carried_;                        ///< what is shown, in the newest picture
  cv::Mat shown_was_in_;                   ///< of the newest picture's pixels, in that of `shown_`
  cv::Mat started_was_in_, started_with_;  ///< in the picture that the network looks at; then shown
  Image<Bgr> started_;                     ///< that picture
  std::future<cv::Mat> running_;           ///< last: it uses what is above
};

}  // namespace diminish
