#include <gmock/gmock.h>

#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "core/mat.h"
#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "diminish/reconstructor.h"
#include "diminish/runner.h"
#include "expect_error.h"
#include "paths.h"

namespace diminish {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The calendar's recording, whose RGB-D camera is only there during the scan.
class Background : public ::testing::Test {
 protected:
  Background() {
    options.memory = "on";
    lone.rgbd.clear();
    const auto source = open_recording(recording, options);
    FrameSet frame;
    while (source->next(frame)) frames.push_back(frame);
  }

  /// The mean difference from the truth inside the mask; levels.
  double error(const FrameSet& frame, const DiminishedFrame& result) const {
    const auto file = recording.folder / "truth/background" / (frame.name + ".jpg");
    cv::Mat difference;
    cv::absdiff(cv::imread(file.string()), as_mat(result.picture), difference);
    const cv::Scalar mean = cv::mean(difference, as_mat(result.mask));
    return (mean[0] + mean[1] + mean[2]) / 3;
  }

  Options options;
  Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "calendar");
  Rig lone = recording.rig;
  std::vector<FrameSet> frames;
};

TEST_F(Background, IsShownWithoutAnyRgbdCameraAndSaysSo) {
  const Scan room = scan_recording(recording, options, {});
  // Not what other tests have registered.
  for (const std::string backend : {"cpu", "reference", "gl", "gl_geometry"}) {
    options.backend = backend;
    std::unique_ptr<Pipeline> with;
    try {
      with = std::make_unique<Pipeline>(lone, recording.scene, options);
    } catch (const Error&) {
      continue;  // this machine cannot run it
    }
    with->set_background(room);
    Pipeline without(lone, recording.scene, options);
    double error_with = 0;
    double error_without = 0;
    for (FrameSet frame : frames) {
      frame.rgbd.clear();
      DiminishedFrame result;
      with->process(frame, result);
      const FrameReport& report = result.report;
      EXPECT_TRUE(report.messages.empty()) << report.messages.front();
      ASSERT_GT(report.mask_pixels, 10000U);
      EXPECT_EQ(report.valid_pixels, report.remembered_pixels) << "nothing is seen now";
      EXPECT_EQ(report.memory.background_pixels, report.remembered_pixels);
      EXPECT_GT(report.remembered_pixels, report.mask_pixels / 2);
      error_with += error(frame, result);
      without.process(frame, result);
      EXPECT_THAT(report.messages, ElementsAre(HasSubstr("no background (diminish scan)")));
      error_without += error(frame, result);
    }
    EXPECT_LT(error_with, 0.8 * error_without) << backend;
  }
}

TEST_F(Background, IsNeededWithoutAnyRgbdCamera) {
  for (const char* memory : {"off", "witnessed"}) {
    options.memory = memory;
    EXPECT_THAT(error_of([&] { Pipeline(lone, recording.scene, options); }),
                HasSubstr("memory: expected 'on', and a background"));
  }
}

}  // namespace
}  // namespace diminish
