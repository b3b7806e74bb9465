#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "diminish/intrinsics.h"

namespace diminish {

/// A camera that explains views of a board, by OpenCV's calibration of its lens model.
struct LensFit {
  using Points = std::vector<cv::Point3f>;  ///< of the board, z = 0
  using Pixels = std::vector<cv::Point2f>;

  LensModel model;
  cv::Mat camera, distortion;
  /// Standard deviations of fx, fy, cx, cy and the coefficients.
  std::vector<double> deviations;
  std::vector<cv::Mat> rotations, translations;  ///< each view's camera_from_board
  double error_px = 0;                           ///< root mean square

  /// with_k3: else k3 of a plumb-bob lens is 0. Throws Error if no camera explains the views.
  static LensFit of(LensModel model, bool with_k3, const std::vector<Points>& points,
                    const std::vector<Pixels>& pixels, const cv::Size& size);

  Intrinsics intrinsics(const cv::Size& size) const;
  Pixels project(const Points& points, const cv::Mat& rotation, const cv::Mat& translation) const;
  /// The pose of a view that was not fitted.
  void find_pose(const Points& points, const Pixels& pixels, cv::Mat& rotation,
                 cv::Mat& translation) const;
};

}  // namespace diminish
