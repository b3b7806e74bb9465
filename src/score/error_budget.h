#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "diminish/score.h"

namespace diminish {

/// A frame's pictures: 8-bit BGR; masks: one channel, all of one size.
struct ErrorInput {
  cv::Mat result, truth;
  cv::Mat region;  ///< where errors count
  cv::Mat mask;    ///< the run's
  cv::Mat seen;    ///< by an RGB-D camera
};

/// To which cause each pixel's squared error is laid.
struct ErrorCauses {
  std::optional<ErrorBudget> budget;  ///< nothing where there is no error at all
  /// One CV_64F picture a cause, as in `error_causes`: squared levels, summed over the channels.
  /// What a shift saves may be negative in a pixel.
  std::array<cv::Mat, error_causes.size()> squares;
};

/// - mask: the object still stands there;
/// - missing: no camera saw it;
/// - pose: of the seen pixels, what a shift of the whole picture by a few pixels would save;
/// - edges: of the rest, what is within 4 pixels of an edge of the truth, or of what was seen;
/// - color: of the rest, what neighbours have in common (shading, shadows, white balance);
/// - texture: what is left: blur, noise.
ErrorCauses find_error_causes(const ErrorInput& whole);

/// Each pixel in the colour of its greatest cause, the lighter the larger its error.
cv::Mat draw_error_causes(const ErrorCauses& causes);

}  // namespace diminish
