#include "pipeline/backend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "analytic_scene.h"
#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "expect_error.h"
#include "mask_overlap.h"
#include "picture_difference.h"
#ifdef DIMINISH_HAS_GL
#include "gl/context.h"
#endif

namespace diminish {
namespace {

/// Draws by the processor, but for the frame `failing_frame`, in which it fails as a GPU does.
class Unreliable : public Reconstructor {
 public:
  static inline std::size_t failing_frame = 0;
  static inline int made = 0;

  explicit Unreliable(const Rig& rig) : processor_(Registry<Reconstructor>::get("cpu")(rig)) {
    ++made;
  }
  void reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                   const OcclusionMasks& masks, const TiledRegion& region, const Options& options,
                   Reconstruction& reconstruction) override {
    if (frame.index == failing_frame) {
      // What it leaves behind must not show.
      reconstruction.region = {};
      reconstruction.source.resize(1, 1, 7);
      throw Error("the driver lost the context");
    }
    processor_->reconstruct(frame, depths, poses, masks, region, options, reconstruction);
  }

 private:
  std::unique_ptr<Reconstructor> processor_;
};

TEST(Backend, WhereTheGpuFailsTheProcessorDrawsTheFrameAndTheNextBeginsAnew) {
  Registry<Reconstructor>::add("unreliable",
                               [](const Rig& rig) { return std::make_unique<Unreliable>(rig); });
  const Recording recording =
      load_recording(std::filesystem::path(DIMINISH_RECORDINGS_DIR) / "calendar");
  Options options;
  Pipeline by_processor(recording.rig, recording.scene, options);
  options.backend = "unreliable";
  Unreliable::failing_frame = 1;
  Unreliable::made = 0;
  Pipeline pipeline(recording.rig, recording.scene, options);
  const auto source = open_recording(recording, options);
  FrameSet frame;
  DiminishedFrame expected;
  DiminishedFrame result;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i == 0) {
      ASSERT_TRUE(source->next(frame));
    }
    frame.index = i;
    by_processor.process(frame, expected);
    pipeline.process(frame, result);
    EXPECT_EQ(result.picture, expected.picture) << i;
    EXPECT_EQ(result.report.messages.size(), expected.report.messages.size() + (i == 1 ? 1 : 0));
    if (i == 1) {
      EXPECT_THAT(
          result.report.messages,
          ::testing::Contains("the driver lost the context; drawn by the processor instead"));
    }
  }
  EXPECT_EQ(Unreliable::made, 2);
}

TEST(Backend, UnknownOnesAreAnErrorThatListsTheKnown) {
  Backend backend(testing::small_rig());
  EXPECT_THAT(error_of([&] { backend.choose("metal"); }),
              ::testing::AllOf(::testing::HasSubstr("'metal'"), ::testing::HasSubstr("cpu")));
}

TEST(Backend, AutoIsTheGpuOnlyWhereHardwareDraws) {
  const testing::AnalyticFrame scene(testing::AnalyticScene{}, {Eigen::Vector3d(-0.45, 0.3, 0.9)});
  bool has_hardware = false;
#ifdef DIMINISH_HAS_GL
  has_hardware = gl::has_hardware_driver();
#endif
  Backend backend(scene.rig);
  backend.choose("auto");
  Reconstruction reconstruction;
  DrawingReport report;
  backend.reconstruct(scene.frame, testing::depths_of(scene.frame), scene.poses,
                      testing::empty_masks(scene.rig), scene.rig.color.bounds(), {}, reconstruction,
                      report);
  EXPECT_EQ(backend.message(), "");
  EXPECT_EQ(!report.device.empty(), has_hardware);
  EXPECT_EQ(!report.passes.empty(), has_hardware);
}

#ifdef DIMINISH_HAS_GL

class WholeFrames : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Recordings, WholeFrames,
                         ::testing::Values("calendar", "ball", "workbench"));

// What users see: the pictures of both backends, and what they score.
TEST_P(WholeFrames, OfTheGpuAreThoseOfTheProcessor) {
  const std::filesystem::path folder = std::filesystem::path(DIMINISH_RECORDINGS_DIR) / GetParam();
  const Recording recording = load_recording(folder);
  Options options;
  Pipeline by_processor(recording.rig, recording.scene, options);
  const auto source = open_recording(recording, options);
  options.backend = "gl";
  Pipeline by_gpu(recording.rig, recording.scene, options);
  FrameSet frame;
  DiminishedFrame a;
  DiminishedFrame b;
  while (source->next(frame)) {
    by_processor.process(frame, a);
    by_gpu.process(frame, b);
    ASSERT_FALSE(b.report.drawing.device.empty());
    EXPECT_EQ(a.mask, b.mask);
    std::size_t other_provenance = 0;
    std::size_t other_color = 0;
    for (std::size_t i = 0; i < a.picture.size(); ++i) {
      if (testing::difference(a.picture.data()[i], b.picture.data()[i]) > 2) ++other_color;
      if (a.provenance.data()[i] != b.provenance.data()[i]) ++other_provenance;
    }
    EXPECT_GT(a.report.valid_pixels, 1000U);
    EXPECT_LE(other_provenance * 1000, a.report.mask_pixels) << frame.name;
    EXPECT_LE(other_color * 1000, a.report.mask_pixels) << frame.name;
    const Image<Bgr> truth = read_color_image(folder / "truth/background" / (frame.name + ".jpg"));
    EXPECT_NEAR(testing::psnr_db(a.picture, truth, a.mask),
                testing::psnr_db(b.picture, truth, b.mask), 0.1)
        << frame.name;
  }
}

#endif

}  // namespace
}  // namespace diminish
