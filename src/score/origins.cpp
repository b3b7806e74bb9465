#include "score/origins.h"

#include <array>
#include <cstdint>

#include "diminish/diminished_frame.h"
#include "score/image_quality.h"

namespace diminish {
namespace {

/// Provenance values, from first to last.
struct Origin {
  std::uint8_t first, last;
};
constexpr std::array<Origin, score_origins.size()> origins{
    {{provenance::first_rgbd, provenance::witnessed - 1},
     {provenance::witnessed, provenance::witnessed},
     {provenance::remembered, provenance::remembered},
     {provenance::estimated, provenance::estimated},
     {provenance::inpainted, provenance::inpainted}}};

}  // namespace

FrameScore::Origins score_by_origin(const cv::Mat& result, const cv::Mat& truth,
                                    const cv::Mat& ssim, const cv::Mat& provenance,
                                    const cv::Mat& region) {
  FrameScore::Origins scores;
  const int pixels = cv::countNonZero(region);
  if (provenance.empty() || pixels == 0) return scores;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const cv::Mat part =
        region & (provenance >= origins[i].first) & (provenance <= origins[i].last);
    if (const auto found = quality(result, truth, ssim, part)) {
      scores[i] = {static_cast<double>(cv::countNonZero(part)) / pixels, *found};
    }
  }
  return scores;
}

FrameScore::Origins mean_by_origin(const std::vector<FrameScore>& frames) {
  FrameScore::Origins means;
  for (std::size_t i = 0; i < means.size(); ++i) {
    OriginScore sum;
    int scored = 0;
    int having = 0;
    for (const FrameScore& frame : frames) {
      scored += frame.inside ? 1 : 0;
      const std::optional<OriginScore>& own = frame.origins[i];
      if (!own) continue;
      ++having;
      sum.share += own->share;
      sum.quality.psnr_db += own->quality.psnr_db;
      sum.quality.ssim += own->quality.ssim;
    }
    if (having == 0) continue;
    means[i] = {sum.share / scored, {sum.quality.psnr_db / having, sum.quality.ssim / having}};
  }
  return means;
}

}  // namespace diminish
