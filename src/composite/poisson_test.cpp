#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "diminish/color_corrector.h"
#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "laplace_equation.h"
#include "paths.h"

namespace diminish {
namespace {

struct Problem {
  Image<Bgr> camera;
  Mask occlusion;
  Reconstruction reconstruction;

  Problem(int width, int height, unsigned seed) : random(seed) {
    camera.resize(width, height);
    occlusion.resize(width, height, 0);
    reconstruction.region = camera.bounds();
    reconstruction.color.resize(width, height);
    reconstruction.depth_m.resize(width, height, 1.F);
    reconstruction.source.resize(width, height, 1);
    for (Bgr& pixel : camera) pixel = {level(), level(), level()};
    for (Bgra& pixel : reconstruction.color) pixel = {level(), level(), level(), 255};
  }
  std::uint8_t level() { return static_cast<std::uint8_t>(60 + random() % 120); }
  void hide(const Rect& rect) {
    for (int y = rect.y; y < rect.bottom(); ++y) {
      for (int x = rect.x; x < rect.right(); ++x) {
        reconstruction.color(x, y) = {};
        reconstruction.source(x, y) = 0;
      }
    }
  }
  bool valid(int x, int y) const {
    return occlusion(x, y) != 0 && reconstruction.color(x, y).a != 0;
  }
  Image<Bgr> solve() const {
    Image<Bgr> picture = camera;
    Registry<ColorCorrector>::get("poisson")()->correct({camera, occlusion, reconstruction, {}},
                                                        picture);
    return picture;
  }

  std::mt19937 random;
};

double value(const Bgr& color, int channel) {
  return channel == 0 ? color.b : channel == 1 ? color.g : color.r;
}

/// In levels.
struct Errors {
  double worst = 0, rms = 0;
};
/// How far the valid pixels are from expected(x, y, channel); the others must be the camera's.
template <class Expected>
void measure(const Problem& problem, const Image<Bgr>& picture, const Expected& expected,
             Errors& errors) {
  double squares = 0;
  int count = 0;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (!problem.valid(x, y)) {
        ASSERT_EQ(picture(x, y), problem.camera(x, y)) << x << ' ' << y;
        continue;
      }
      for (int c = 0; c < 3; ++c) {
        const double error = std::abs(value(picture(x, y), c) - expected(x, y, c));
        errors.worst = std::max(errors.worst, error);
        squares += error * error;
        ++count;
      }
    }
  }
  errors.rms = std::sqrt(squares / count);
}

/// By a direct solve: half a level for rounding, and what the solver may leave, everywhere; nothing
/// else changes.
void expect_exact(const Problem& problem, double worst_error = 1.1, double largest_rms = 0.49) {
  const Reconstruction& reconstruction = problem.reconstruction;
  const Image<Eigen::Array3d> exact = testing::exact_cloning(
      problem.camera, reconstruction.color, problem.occlusion, reconstruction.source);
  Errors errors;
  measure(
      problem, problem.solve(),
      [&](int x, int y, int c) { return std::clamp(exact(x, y)[c], 0.0, 255.0); }, errors);
  EXPECT_LE(errors.worst, 0.5 + worst_error);
  // Rounding alone leaves 0.29.
  EXPECT_LE(errors.rms, largest_rms);
}

void fill(Mask& mask, const Rect& rect) {
  mask.fill(rect, 255);
}

TEST(PoissonCorrection, EqualsADirectSolveOnARectangle) {
  Problem problem(130, 97, 1);
  fill(problem.occlusion, {20, 15, 83, 61});
  expect_exact(problem);
}

TEST(PoissonCorrection, EqualsADirectSolveWithHolesThinLinesAndAtThePicturesEdge) {
  Problem problem(257, 90, 2);
  fill(problem.occlusion, {0, 0, 120, 70});
  fill(problem.occlusion, {140, 3, 1, 80});  // a line of one pixel
  fill(problem.occlusion, {150, 40, 107, 1});
  fill(problem.occlusion, {170, 60, 3, 3});
  problem.hide({30, 20, 40, 25});   // free borders inside
  problem.hide({0, 60, 80, 10});    // ... and on the mask's rim
  problem.hide({100, 65, 30, 10});  // not reconstructed outside the mask either
  expect_exact(problem);
}

TEST(PoissonCorrection, EqualsADirectSolveOnRandomSpeckle) {
  for (unsigned seed = 3; seed < 8; ++seed) {
    Problem problem(61, 43, seed);
    for (std::uint8_t& pixel : problem.occlusion) pixel = problem.random() % 3 == 0 ? 255 : 0;
    expect_exact(problem);
  }
}

TEST(PoissonCorrection, EqualsADirectSolveAcrossTheSeamOfTwoCameras) {
  Problem problem(100, 80, 9);
  fill(problem.occlusion, {10, 10, 80, 60});
  for (int y = 0; y < 80; ++y) {
    for (int x = 40 + y / 4; x < 100; ++x) {
      problem.reconstruction.source(x, y) = 2;
      problem.reconstruction.color(x, y).b =
          static_cast<std::uint8_t>(problem.reconstruction.color(x, y).b + 60);
    }
  }
  expect_exact(problem);
}

TEST(PoissonCorrection, EqualsADirectSolveAtAwkwardSizes) {
  for (const int size : {1, 3, 13, 257}) {
    Problem problem(size + 2, 9, static_cast<unsigned>(size));
    fill(problem.occlusion, {1, 1, size, 7});
    expect_exact(problem);
  }
}

// So large that fine grids are left out in the middle, with noise on the boundary and free borders
// inside.
TEST(PoissonCorrection, EqualsADirectSolveOnALargeMask) {
  Problem problem(700, 520, 21);
  for (int y = 0; y < 520; ++y) {
    for (int x = 0; x < 700; ++x) {
      if (std::hypot(x - 330, y - 260) < 240) problem.occlusion(x, y) = 255;
    }
  }
  problem.hide({300, 180, 37, 41});
  problem.hide({0, 250, 150, 3});
  expect_exact(problem, 2, 0.5);
}

// Strips that hang on one end are what depth edges leave of a background: one 17 pixels wide and
// 400 long, one that hangs on 8 pixels, beside large parts that they do not touch.
TEST(PoissonCorrection, EqualsADirectSolveOnNarrowStrips) {
  Problem problem(600, 500, 22);
  for (int y = 20; y < 480; ++y) std::fill_n(problem.occlusion.row(y) + 20, 560, 255);
  // Another exposure, darker towards the right; and noise.
  for (int y = 0; y < 500; ++y) {
    for (int x = 0; x < 600; ++x) {
      const Bgra& color = problem.reconstruction.color(x, y);
      const auto seen = [&](std::uint8_t level) {
        return static_cast<std::uint8_t>(level + 60 - x / 5 +
                                         static_cast<int>(problem.random() % 20));
      };
      problem.camera(x, y) = {seen(color.b), seen(color.g), seen(color.r)};
    }
  }
  for (const Rect& rect : {Rect{190, 0, 24, 450}, Rect{231, 60, 24, 440}, Rect{190, 430, 65, 24},
                           Rect{330, 90, 24, 360}, Rect{375, 90, 24, 360}, Rect{330, 440, 69, 24},
                           Rect{330, 70, 31, 24}, Rect{369, 70, 30, 24}}) {
    problem.hide(rect);
  }
  expect_exact(problem, 4, 0.5);
}

// Grids are kept from one frame to the next; what was in them must not show.
TEST(PoissonCorrection, RemembersNoOtherFrame) {
  const auto used = Registry<ColorCorrector>::get("poisson")();
  std::mt19937 random(23);
  for (int round = 0; round < 12; ++round) {
    Problem problem(420, 300, 30U + static_cast<unsigned>(round));
    // Of the same size at times, and of others.
    const int right = round % 3 == 0 ? 400 : 300 + static_cast<int>(random() % 100);
    for (int k = 0; k < 9; ++k) {
      const int x = 10 + static_cast<int>(random() % 200);
      const int y = 10 + static_cast<int>(random() % 200);
      const int width = k == 0 ? right - x : 20 + static_cast<int>(random() % 90);
      for (int row = y; row < y + 80; ++row) {
        std::fill_n(problem.occlusion.row(row) + x, width, 255);
      }
    }
    for (int k = 0; k < 6; ++k) {
      problem.hide({static_cast<int>(random() % 380), static_cast<int>(random() % 260), 35, 33});
    }
    if (round % 4 == 1) {  // two RGB-D cameras: sources along the seam
      for (int y = 0; y < 300; ++y) {
        for (int x = 150; x < 420; ++x) {
          if (problem.reconstruction.source(x, y) == 1) problem.reconstruction.source(x, y) = 2;
        }
      }
    }
    Image<Bgr> picture = problem.camera;
    used->correct({problem.camera, problem.occlusion, problem.reconstruction, {}}, picture);
    ASSERT_EQ(picture, problem.solve()) << round;
  }
}

class PoissonOnRecordings : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Recordings, PoissonOnRecordings,
                         ::testing::Values("calendar", "ball", "workbench"));

TEST_P(PoissonOnRecordings, EqualsADirectSolve) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / GetParam());
  FrameSet frame;
  DiminishedFrame result;
  open_recording(recording, {})->next(frame);
  Pipeline(recording.rig, recording.scene, {}).process(frame, result);
  Problem problem(1, 1, 0);
  problem.camera = frame.color.own();
  problem.occlusion = result.mask;
  problem.reconstruction = result.reconstruction;
  // Parts that hang on a few pixels may be further off.
  expect_exact(problem, 8, 0.5);
}

// A correction that is a linear ramp on the boundary is that ramp inside: it is harmonic.
TEST(PoissonCorrection, ReproducesARampExactly) {
  Problem problem(120, 90, 10);
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      const Bgra& color = problem.reconstruction.color(x, y);
      problem.camera(x, y) = {static_cast<std::uint8_t>(color.b + x / 4 - 15),
                              static_cast<std::uint8_t>(color.g + 7),
                              static_cast<std::uint8_t>(color.r - y / 3)};
    }
  }
  // Steps of a quarter level are rounded in the 8-bit boundary; a constant is not.
  fill(problem.occlusion, {8, 8, 100, 70});
  const Image<Bgr> picture = problem.solve();
  for (int y = 8; y < 78; ++y) {
    for (int x = 8; x < 108; ++x) {
      EXPECT_EQ(picture(x, y).g, problem.camera(x, y).g);
      EXPECT_NEAR(picture(x, y).b, problem.camera(x, y).b, 1);
      EXPECT_NEAR(picture(x, y).r, problem.camera(x, y).r, 1);
    }
  }
}

// With cv::seamlessClone the object's own colours bleed into the result.
TEST(PoissonCorrection, NeverLooksAtTheObject) {
  Problem problem(140, 110, 11);
  fill(problem.occlusion, {0, 20, 90, 60});
  problem.hide({0, 30, 50, 30});
  const Image<Bgr> before = problem.solve();
  for (int y = 0; y < 110; ++y) {
    for (int x = 0; x < 140; ++x) {
      if (problem.occlusion(x, y) != 0) {
        problem.camera(x, y) = {problem.level(), problem.level(), problem.level()};
      }
    }
  }
  const Image<Bgr> after = problem.solve();
  for (int y = 0; y < 110; ++y) {
    for (int x = 0; x < 140; ++x) {
      if (!problem.valid(x, y)) continue;
      ASSERT_EQ(before(x, y), after(x, y)) << x << ' ' << y;
    }
  }
}

// An island that meets the camera's picture nowhere gets the mean correction of the rest.
TEST(PoissonCorrection, AnIslandGetsTheMeanCorrection) {
  Problem problem(100, 60, 12);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 100; ++x) {
      const Bgra& color = problem.reconstruction.color(x, y);
      problem.camera(x, y) = {static_cast<std::uint8_t>(color.b + 20), color.g,
                              static_cast<std::uint8_t>(color.r - 12)};
    }
  }
  fill(problem.occlusion, {5, 5, 90, 50});
  problem.hide({50, 5, 45, 50});
  problem.hide({95, 0, 5, 60});
  problem.hide({50, 0, 50, 5});
  problem.hide({50, 55, 50, 5});
  for (int y = 20; y < 30; ++y) {
    for (int x = 70; x < 80; ++x) {
      problem.reconstruction.color(x, y) = {100, 100, 100, 255};
      problem.reconstruction.source(x, y) = 1;
    }
  }
  EXPECT_EQ(problem.solve()(75, 25), (Bgr{120, 100, 88}));
  // Nothing at all to go by: the colours stay.
  problem.hide({0, 0, 70, 60});
  EXPECT_EQ(problem.solve()(75, 25), (Bgr{100, 100, 100}));
}

TEST(PoissonCorrection, AnObjectUsedTwiceForgetsTheFirstFrame) {
  const auto corrector = Registry<ColorCorrector>::get("poisson")();
  Problem large(150, 120, 13);
  fill(large.occlusion, {10, 10, 120, 90});
  Problem small(60, 50, 14);
  fill(small.occlusion, {5, 5, 40, 30});
  Image<Bgr> picture = large.camera;
  corrector->correct({large.camera, large.occlusion, large.reconstruction, {}}, picture);
  picture = small.camera;
  corrector->correct({small.camera, small.occlusion, small.reconstruction, {}}, picture);
  EXPECT_EQ(picture, small.solve());
}

TEST(PoissonCorrection, LeavesThePictureAloneWithoutMaskOrReconstruction) {
  Problem problem(40, 30, 15);
  EXPECT_EQ(problem.solve(), problem.camera);
  fill(problem.occlusion, {5, 5, 20, 20});
  problem.hide({0, 0, 40, 30});
  EXPECT_EQ(problem.solve(), problem.camera);
}

}  // namespace
}  // namespace diminish
