#pragma once

#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <string>

#include "diminish/score.h"
#include "score/error_budget.h"

namespace diminish {

/// A frame that has a result and a truth. input: empty where it is not known.
struct ScoredFrame {
  const std::string& name;
  const cv::Mat &input, &result, &truth, &mask, &provenance;
  const ErrorCauses& causes;
};

/// `score_run`, which calls `visit` with each frame as it is scored.
Score score_frames(const std::filesystem::path& recording, const std::filesystem::path& run,
                   const std::function<void(const ScoredFrame&)>& visit);

}  // namespace diminish
