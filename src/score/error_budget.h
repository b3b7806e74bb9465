#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "diminish/score.h"

namespace diminish {

/// A frame's pictures (8-bit BGR) and masks (one channel), all of one size.
struct ErrorInput {
  cv::Mat result, truth;
  cv::Mat region;  ///< where errors count
  cv::Mat mask;    ///< the run's
  cv::Mat seen;    ///< by an RGB-D camera
};

/// The cause of each pixel's squared error.
struct ErrorCauses {
  std::optional<ErrorBudget> budget;  ///< nothing if there is no error at all
  /// One CV_64F picture per cause, as in `error_causes`: squared levels, summed over the channels.
  /// What a shift saves may be negative in a pixel.
  std::array<cv::Mat, error_causes.size()> squares;
};

/// - mask: the object is still visible;
/// - missing: no camera saw it;
/// - pose: of the seen pixels, the error that a shift of the whole picture by a few pixels would
/// save;
/// - edges: of the rest, pixels within 4 pixels of an edge of the truth or of what was seen;
/// - color: of the rest, the error that neighbours share (shading, shadows, white balance);
/// - texture: the rest: blur, noise.
ErrorCauses find_error_causes(const ErrorInput& whole);

/// Draws each pixel in the colour of its main cause, lighter for larger errors.
cv::Mat draw_error_causes(const ErrorCauses& causes);

}  // namespace diminish
