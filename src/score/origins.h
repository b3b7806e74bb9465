#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "diminish/score.h"

namespace diminish {

/// Scores each origin's pixels apart. provenance: empty where it is not known. ssim: of the whole
/// picture. region: the pixels that count.
FrameScore::Origins score_by_origin(const cv::Mat& result, const cv::Mat& truth,
                                    const cv::Mat& ssim, const cv::Mat& provenance,
                                    const cv::Mat& region);

/// Shares are means over all frames, qualities over those that have such pixels.
FrameScore::Origins mean_by_origin(const std::vector<FrameScore>& frames);

}  // namespace diminish
