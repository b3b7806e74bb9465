#include "pipeline/backend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "analytic_scene.h"
#include "core/mat.h"
#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "diminish/view_mode.h"
#include "expect_error.h"
#include "gpu_options.h"
#include "mask_overlap.h"
#include "paths.h"
#include "picture_difference.h"
#include "score/image_quality.h"
#ifdef DIMINISH_HAS_GL
#include "gl/context.h"
#endif

namespace diminish {
namespace {

/// What a GPU leaves behind where it fails must not show.
[[noreturn]] void fail(Reconstruction& reconstruction) {
  reconstruction.region = {};
  reconstruction.source.resize(1, 1, 7);
  throw Error("the driver lost the context");
}

/// Draws by the CPU, but for the frame `failing_frame`, in which it fails as a GPU does.
class Unreliable : public Reconstructor {
 public:
  static inline std::size_t failing_frame = 1;
  static inline int made = 0;

  explicit Unreliable(const Rig& rig) : cpu_(Registry<Reconstructor>::get("cpu")(rig)) { ++made; }
  void reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                   const OcclusionMasks& masks, const TiledRegion& region, const Options& options,
                   Reconstruction& reconstruction) override {
    if (frame.index == failing_frame) fail(reconstruction);
    cpu_->reconstruct(frame, depths, poses, masks, region, options, reconstruction);
  }

 private:
  std::unique_ptr<Reconstructor> cpu_;
};

/// Cannot compose anything.
class Helpless : public ComposingReconstructor {
 public:
  static inline int made = 0;

  Helpless() { ++made; }
  bool takes_over(Stage, const FrameMethods&) const override { return true; }
  void compose(const FrameInputs&, Stage, DiminishedFrame& result) override {
    result.picture.resize(1, 1, {1, 2, 3});
    result.report.mask_pixels = 77;
    fail(result.reconstruction);
  }
  void reconstruct(const FrameSet&, const DepthImages&, const Poses&, const OcclusionMasks&,
                   const TiledRegion&, const Options&, Reconstruction& reconstruction) override {
    fail(reconstruction);
  }
};

/// Three times the same frame. failures: those in which the backend fails.
void expect_the_cpus_frames(const std::string& backend, const std::vector<bool>& failures) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "calendar");
  Options options = testing::gpu_options();
  Pipeline by_cpu(recording.rig, recording.scene, options);
  options.backend = backend;
  Pipeline pipeline(recording.rig, recording.scene, options);
  FrameSet frame;
  ASSERT_TRUE(open_recording(recording, options)->next(frame));
  DiminishedFrame expected;
  DiminishedFrame result;
  for (std::size_t i = 0; i < failures.size(); ++i) {
    frame.index = i;
    by_cpu.process(frame, expected);
    pipeline.process(frame, result);
    EXPECT_EQ(result.picture, expected.picture) << i;
    EXPECT_EQ(result.provenance, expected.provenance) << i;
    EXPECT_EQ(result.report.mask_pixels, expected.report.mask_pixels) << i;
    EXPECT_EQ(result.report.messages.size(),
              expected.report.messages.size() + (failures[i] ? 1 : 0));
    if (failures[i]) {
      EXPECT_THAT(result.report.messages,
                  ::testing::Contains("the driver lost the context; drawn by the CPU instead"));
    }
  }
}

TEST(Backend, WhereTheGpuFailsTheCpuDrawsTheFrameAndTheNextBeginsAnew) {
  Registry<Reconstructor>::add("unreliable",
                               [](const Rig& rig) { return std::make_unique<Unreliable>(rig); });
  Unreliable::made = 0;
  expect_the_cpus_frames("unreliable", {false, true, false});
  EXPECT_EQ(Unreliable::made, 2);
}

TEST(Backend, WhereTheGpuFailsOnTheWayToThePictureTheCpuDoesTheFrame) {
  Registry<Reconstructor>::add("helpless", [](const Rig&) { return std::make_unique<Helpless>(); });
  Helpless::made = 0;
  expect_the_cpus_frames("helpless", {true, true});
  EXPECT_EQ(Helpless::made, 2);
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
  const TiledRegion region = scene.rig.color.bounds();
  const DepthImages depths = testing::depths_of(scene.frame);
  const OcclusionMasks masks = testing::empty_masks(scene.rig);
  const Options options;
  const FrameMethods methods{{}, {.rule = Inpainter::Declaration::Rule::by_surface}, "remove"};
  DiminishedFrame result;
  backend.begin_frame();
  backend.draw({scene.frame,
                depths,
                scene.poses,
                masks,
                {},
                region,
                options,
                methods,
                nullptr,
                {},
                {},
                true},
               result);
  const DrawingReport& report = result.report.drawing;
  EXPECT_FALSE(backend.has_done(Stage::compositing)) << "the correction has its own rule";
  EXPECT_EQ(backend.message(), "");
  EXPECT_EQ(!report.device.empty(), has_hardware);
  EXPECT_EQ(!report.passes.empty(), has_hardware);
}

#ifdef DIMINISH_HAS_GL

class WholeFrames : public ::testing::TestWithParam<const char*> {
 protected:
  std::filesystem::path folder = std::filesystem::path(testing::recordings_dir()) / GetParam();
  Recording recording = load_recording(folder);
  Pipeline by_cpu{recording.rig, recording.scene, {}};
  Pipeline by_gpu{recording.rig, recording.scene, {}};
  FrameSet frame;
  DiminishedFrame expected, result;

  void process_both(const Options& options) {
    Options on_gpu = options;
    on_gpu.backend = "gl";
    by_cpu.set_options(options);
    by_gpu.set_options(on_gpu);
    by_cpu.process(frame, expected);
    by_gpu.process(frame, result);
  }

  /// Provenance but for 0.1 % of the mask's pixels, colours within 2 levels but for 0.1 %.
  void expect_alike(const std::string& what) const {
    ASSERT_FALSE(result.report.drawing.device.empty());
    EXPECT_EQ(expected.mask, result.mask);
    EXPECT_EQ(result.report.mask_pixels, expected.report.mask_pixels);
    EXPECT_EQ(result.report.messages, expected.report.messages);
    EXPECT_GT(expected.report.valid_pixels, 1000U);
    std::size_t other_provenance = 0;
    std::size_t other_color = 0;
    for (std::size_t i = 0; i < expected.picture.size(); ++i) {
      const Bgr& a = expected.picture.data()[i];
      const Bgr& b = result.picture.data()[i];
      if (testing::difference(a, b) > 2) ++other_color;
      if (expected.provenance.data()[i] != result.provenance.data()[i]) ++other_provenance;
    }
    EXPECT_LE(other_provenance * 1000, expected.report.mask_pixels) << what;
    EXPECT_LE(other_color * 1000, expected.report.mask_pixels) << what;
  }

  void expect_camera_outside(const std::string& what) const {
    for (std::size_t i = 0; i < result.mask.size(); ++i) {
      if (result.mask.data()[i] != 0) continue;
      ASSERT_EQ(result.picture.data()[i], frame.color.view().data()[i]) << what;
    }
  }

  Quality quality_of(const DiminishedFrame& frame_result, const cv::Mat& truth) const {
    const cv::Mat picture = as_mat(frame_result.picture);
    return *quality(picture, truth, ssim_map(picture, truth), as_mat(expected.mask));
  }
};
INSTANTIATE_TEST_SUITE_P(Recordings, WholeFrames,
                         ::testing::Values("calendar", "ball", "workbench"),
                         [](const auto& test) { return std::string(test.param); });

// What users see: the pictures of both backends, and what they score.
TEST_P(WholeFrames, OfTheGpuAreThoseOfTheCpu) {
  const auto source = open_recording(recording, {});
  while (source->next(frame)) {
    process_both(testing::gpu_options());
    expect_alike(frame.name);
    expect_camera_outside(frame.name);
    const Image<Bgr> truth = read_color_image(folder / "truth/background" / (frame.name + ".jpg"));
    const Quality a = quality_of(expected, as_mat(truth));
    const Quality b = quality_of(result, as_mat(truth));
    EXPECT_NEAR(a.psnr_db, b.psnr_db, 0.1) << frame.name;
    EXPECT_NEAR(a.ssim, b.ssim, 0.002) << frame.name;
  }
}

TEST_P(WholeFrames, OfTheGpuAreThoseOfTheCpuInEveryMode) {
  ASSERT_TRUE(open_recording(recording, {})->next(frame));
  for (const char* inpainting : {"surfaces", "none"}) {
    for (const std::string& mode : Registry<ViewMode>::names()) {
      Options options = testing::gpu_options();
      options.mode = mode;
      options.inpaint = inpainting;
      options.soft_rim_px = mode == "half" ? 0 : 2;
      process_both(options);
      expect_alike(mode);
      expect_camera_outside(mode);
    }
  }
}

TEST_P(WholeFrames, OfTheGpuAreThoseOfTheCpuWithOtherOptions) {
  ASSERT_TRUE(open_recording(recording, {})->next(frame));
  for (const char* what :
       {"remove_shadows", "with shadows", "whole_view", "harmonic", "none", "surroundings_px"}) {
    const std::string name = what;
    Options options = testing::gpu_options();
    options.inpaint = name == "harmonic" ? "harmonic" : "none";
    options.remove_shadows = name == "remove_shadows";
    options.lift_shadows = name != "with shadows";
    options.whole_view = name == "whole_view";
    options.surroundings_px = name == "surroundings_px" ? 1 : 16;
    if (name == "none") options.color_correct = "none";
    process_both(options);
    expect_alike(name);
    if (!options.remove_shadows) expect_camera_outside(name);
  }
}

// It stays on the GPU; nothing else changes, nor does it when it is wanted again.
TEST_P(WholeFrames, DoNotNeedTheReconstructionWhereNobodyLooksAtIt) {
  Options options = testing::gpu_options();
  options.backend = "gl";
  options.inpaint = "none";
  ASSERT_TRUE(open_recording(recording, {})->next(frame));
  Pipeline pipeline(recording.rig, recording.scene, options);
  pipeline.process(frame, expected);
  EXPECT_FALSE(expected.reconstruction.color.empty());
  pipeline.want_reconstruction(false);
  pipeline.process(frame, result);
  EXPECT_EQ(result.picture, expected.picture);
  EXPECT_EQ(result.provenance, expected.provenance);
  EXPECT_EQ(result.reconstruction.region, expected.reconstruction.region);
  EXPECT_TRUE(result.reconstruction.color.empty());
  pipeline.want_reconstruction(true);
  pipeline.process(frame, result);
  EXPECT_EQ(result.reconstruction.color, expected.reconstruction.color);
  EXPECT_EQ(result.surfaces.label, expected.surfaces.label);
  EXPECT_EQ(result.surfaces.light, expected.surfaces.light);
}

TEST(WholeFrame, WithoutObjectsOrRgbdCamerasIsTheGpusToo) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "ball");
  Options options = testing::gpu_options();
  options.backend = "gl";
  options.inpaint = "none";
  FrameSet frame;
  ASSERT_TRUE(open_recording(recording, {})->next(frame));
  Pipeline pipeline(recording.rig, recording.scene, options);
  DiminishedFrame result;
  pipeline.process(frame, result);
  frame.rgbd[0].missing = "unplugged";
  pipeline.process(frame, result);
  EXPECT_GT(result.report.mask_pixels, 1000U);
  EXPECT_EQ(result.report.missing_pixels, result.report.mask_pixels);
  options.keep = recording.scene.occluders.front().name;
  pipeline.set_options(options);
  pipeline.process(frame, result);
  EXPECT_EQ(result.picture, frame.color.own());
  EXPECT_EQ(result.report.mask_pixels, 0U);
}

#endif

}  // namespace
}  // namespace diminish
