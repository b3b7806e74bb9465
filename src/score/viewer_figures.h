#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "diminish/score.h"

namespace diminish {

/// A frame's pictures: 8-bit BGR; ssim: CV_64F; provenance: empty where it is not known.
struct ViewerInput {
  cv::Mat result, truth, ssim;
  cv::Mat mask;  ///< the true one, or without one the run's
  cv::Mat provenance;
};

/// Nothing where the mask is empty.
std::optional<ViewerFigures> viewer_figures(const ViewerInput& input);

/// Each figure's mean over the frames that have it; F1 is that of the means.
std::optional<ViewerFigures> mean_of(const std::vector<ViewerFigures>& frames);

}  // namespace diminish
