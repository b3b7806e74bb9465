#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace diminish {

/// How a ball looks in a picture: an ellipse, possibly cut off at the picture's border.
struct RoundShape {
  cv::Point2d center;
  cv::Size2d half_axes;
  double angle_rad = 0;  ///< of the first axis
  /// Intersection over union of the region that it was fitted to and the ellipse's visible part.
  double agreement = 0;

  double diameter() const { return half_axes.width + half_axes.height; }
  /// Sets the pixels whose centres are inside to 255.
  void draw(cv::Mat& mask) const;
};

/// Fits an ellipse to `outline`, the outer contour of `region` (255 inside; the whole picture); a
/// circle where the region is cut off, because a short arc says little about an ellipse. A small
/// part of the outline may be wrong. Nothing if there are too few points for a fit.
std::optional<RoundShape> fit_round_shape(const std::vector<cv::Point>& outline,
                                          const cv::Mat& region);

/// Whether a region is what a ball may look like.
bool is_round(const RoundShape& shape);

}  // namespace diminish
