#include "gl/membrane_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "composite/membrane_methods.h"
#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "paths.h"
#include "picture_difference.h"

namespace diminish {
namespace {

/// Pixels of `mask` whose colours differ by more than a level; and the largest difference.
struct Difference {
  std::size_t pixels = 0, other = 0;
  int most = 0;
};

Difference compare(const Image<Bgr>& a, const Image<Bgr>& b, const Mask& mask) {
  Difference difference;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (mask.data()[i] == 0) {
      EXPECT_EQ(a.data()[i], b.data()[i]);
      continue;
    }
    const int levels = testing::difference(a.data()[i], b.data()[i]);
    ++difference.pixels;
    difference.other += levels > 1 ? 1 : 0;
    difference.most = std::max(difference.most, levels);
  }
  return difference;
}

class GlMembrane : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Recordings, GlMembrane,
                         ::testing::Values("calendar", "ball", "workbench"));

// Beside the plain versions, which solve the same equations pixel by pixel: borders of all kinds,
// strips, loose parts, seams between two cameras.
TEST_P(GlMembrane, SolvesWhatThePlainVersionsSolve) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / GetParam());
  Options options;
  options.lift_shadows = false;
  const auto source = open_recording(recording, options);
  Pipeline pipeline(recording.rig, recording.scene, options);
  const auto on_gpu = Registry<ColorCorrector>::get("gl_poisson")();
  const auto plain = Registry<ColorCorrector>::get("poisson_reference")();
  const auto filling_on_gpu = Registry<Inpainter>::get("gl_harmonic")();
  const auto plain_filling = Registry<Inpainter>::get("harmonic_reference")();
  FrameSet frame;
  DiminishedFrame result;
  // Once twice, so that what an earlier frame left behind would show.
  const int frames = GetParam() == std::string("ball") ? 2 : 1;
  for (int i = 0; i < frames && source->next(frame); ++i) {
    pipeline.process(frame, result);
    Mask seen(result.mask.width(), result.mask.height(), 0);
    Mask missing = seen;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const std::uint8_t from = result.provenance.data()[k];
      seen.data()[k] = from >= provenance::first_rgbd && from < provenance::inpainted ? 255 : 0;
      missing.data()[k] = from == provenance::inpainted ? 255 : 0;
    }
    Image<Bgr> a = frame.color;
    Image<Bgr> b = frame.color;
    on_gpu->correct({frame.color, result.mask, result.reconstruction, {}}, a);
    plain->correct({frame.color, result.mask, result.reconstruction, {}}, b);
    const Difference corrected = compare(a, b, seen);
    EXPECT_GT(corrected.pixels, 1000U);
    EXPECT_LE(corrected.other * 1000, corrected.pixels) << "at most " << corrected.most;

    Image<Bgr> c = result.picture;
    Image<Bgr> d = result.picture;
    const Holes holes{missing, result.mask, result.surfaces};
    EXPECT_TRUE(filling_on_gpu->inpaint(holes, options, c));
    EXPECT_TRUE(plain_filling->inpaint(holes, options, d));
    const Difference filled = compare(c, d, missing);
    EXPECT_GT(filled.pixels, 1000U);
    EXPECT_LE(filled.other * 1000, filled.pixels) << "at most " << filled.most;
  }
}

// `--backend gl` takes them of itself.
TEST(GlMembraneSolver, IsUsedWhereTheFrameIsDrawnOnTheGpu) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "ball");
  Options options;
  options.backend = "gl";
  options.color_correct = "poisson";
  options.inpaint = "harmonic";
  FrameSet frame;
  DiminishedFrame a;
  DiminishedFrame b;
  open_recording(recording, options)->next(frame);
  Pipeline(recording.rig, recording.scene, options).process(frame, a);
  options.color_correct = "gl_poisson";
  options.inpaint = "gl_harmonic";
  Pipeline(recording.rig, recording.scene, options).process(frame, b);
  EXPECT_EQ(a.picture, b.picture);
  EXPECT_EQ(a.report.messages, b.report.messages);
}

}  // namespace
}  // namespace diminish
