#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "diminish/score.h"
#include "score/run_folder.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

constexpr int panel_height_px = 400;
constexpr int caption_height_px = 28;

cv::Mat make_panel(const cv::Mat& picture, const char* caption) {
  const double scale = static_cast<double>(panel_height_px) / picture.rows;
  cv::Mat scaled;
  cv::resize(picture, scaled, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  cv::Mat panel;
  cv::copyMakeBorder(scaled, panel, caption_height_px, 0, 0, 4, cv::BORDER_CONSTANT,
                     cv::Scalar::all(255));
  cv::putText(panel, caption, {6, caption_height_px - 9}, cv::FONT_HERSHEY_SIMPLEX, 0.6,
              cv::Scalar::all(40), 1, cv::LINE_AA);
  return panel;
}

}  // namespace

void write_score_pictures(const std::filesystem::path& recording,
                          const std::filesystem::path& run) {
  const RunFolder folder(recording, run);
  std::filesystem::create_directories(run / "score");
  for (const std::string& name : folder.frames()) {
    const auto pictures = folder.object_pictures(name);
    if (!pictures) continue;
    cv::Mat error;
    cv::absdiff(pictures->result, pictures->truth, error);
    cv::Mat sheet;
    cv::hconcat(std::vector<cv::Mat>{make_panel(pictures->input, "input"),
                                     make_panel(pictures->result, "result"),
                                     make_panel(pictures->truth, "truth"),
                                     make_panel(4 * error, "error x 4")},
                sheet);
    write_png(run / "score" / (name + ".png"), sheet);
  }
}

}  // namespace diminish
