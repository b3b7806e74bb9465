#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "score/run_folder.h"
#include "score/score_frames.h"
#include "sink/palette.h"
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

/// The provenance's values in the colours of its palette.
cv::Mat in_colors(const cv::Mat& provenance, cv::Size size) {
  cv::Mat picture = cv::Mat::zeros(size, CV_8UC3);
  for (int y = 0; y < provenance.rows; ++y) {
    for (int x = 0; x < provenance.cols; ++x) {
      const Bgr& color = provenance_palette()[provenance.at<std::uint8_t>(y, x)];
      picture.at<cv::Vec3b>(y, x) = {color.b, color.g, color.r};
    }
  }
  return picture;
}

/// The three greatest shares.
std::string describe(const ErrorCauses& causes) {
  if (!causes.budget) return "no error";
  std::vector<std::size_t> order(error_causes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return (*causes.budget)[a] > (*causes.budget)[b];
  });
  std::string text;
  for (std::size_t i = 0; i < 3; ++i) {
    text += fmt::format("{}{} {:.0f} %", i == 0 ? "" : ", ", error_causes[order[i]],
                        100 * (*causes.budget)[order[i]]);
  }
  return text;
}

cv::Mat draw_sheet(const ScoredFrame& frame) {
  const cv::Rect part = RunFolder::surroundings(frame.mask);
  cv::Mat error;
  cv::absdiff(frame.result(part), frame.truth(part), error);
  cv::Mat upper;
  cv::hconcat(std::vector<cv::Mat>{make_panel(frame.input(part), "input"),
                                   make_panel(frame.result(part), "result"),
                                   make_panel(frame.truth(part), "truth")},
              upper);
  cv::Mat lower;
  cv::hconcat(
      std::vector<cv::Mat>{
          make_panel(4 * error, "error x 4"),
          make_panel(in_colors(frame.provenance, frame.mask.size())(part), "provenance"),
          make_panel(draw_error_causes(frame.causes)(part), describe(frame.causes).c_str())},
      lower);
  cv::Mat sheet;
  cv::vconcat(upper, lower, sheet);
  return sheet;
}

}  // namespace

Score score_run_with_pictures(const std::filesystem::path& recording,
                              const std::filesystem::path& run) {
  const std::filesystem::path folder = run / "score";
  return score_frames(recording, run, [&](const ScoredFrame& frame) {
    if (frame.input.empty()) return;
    std::filesystem::create_directories(folder);
    write_png(folder / (frame.name + ".png"), draw_sheet(frame));
  });
}

}  // namespace diminish
