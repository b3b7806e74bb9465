#include "membrane/smooth_filling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace diminish {
namespace {

/// Fills the open pixels of a window from a colour known everywhere else; the filled picture.
/// top: the first row that holds open ones.
template <class IsOpen, class Color>
Image<Eigen::Array3f> fill(int width, int height, const IsOpen& is_open, const Color& color,
                           int top = 0) {
  SmoothFilling filling;
  Image<Eigen::Array3f> picture(width, height, Eigen::Array3f::Zero());
  // Twice: what the first left behind must not matter.
  for (int run = 0; run < 2; ++run) {
    Image<SmoothFilling::Kind>& kinds = filling.begin({0, top, width, height - top});
    kinds.fill(SmoothFilling::absent);
    for (int y = top; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        kinds(x + 1, y - top + 1) = is_open(x, y) ? SmoothFilling::open : SmoothFilling::known;
      }
    }
    EXPECT_TRUE(filling.connect(color));
    filling.solve();
    filling.for_each_run([&](int y, int first, int last, const Eigen::Array4f* colors) {
      for (int x = first; x < last; ++x) picture(x, y) = colors[x].head<3>();
    });
  }
  return picture;
}

// Against analytic solutions of Laplace's equation.
TEST(SmoothFilling, FollowsAHarmonicFunction) {
  const auto harmonic = [](int x, int y) -> Eigen::Array3f {
    const std::complex<float> z((static_cast<float>(x) - 60) / 60,
                                (static_cast<float>(y) - 50) / 60);
    const std::complex<float> cube = z * z * z;
    return {128 + 60 * z.real(), 128 + 60 * (z * z).imag(), 128 + 30 * cube.real()};
  };
  const auto is_open = [](int x, int y) {
    return std::hypot(x - 60, y - 50) < 45 && std::hypot(x - 50, y - 50) > 8;
  };
  const Image<Eigen::Array3f> picture = fill(120, 100, is_open, harmonic);
  double squares = 0;
  int count = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 120; ++x) {
      if (!is_open(x, y)) continue;
      squares += static_cast<double>((picture(x, y) - harmonic(x, y)).square().mean());
      ++count;
    }
  }
  EXPECT_LT(std::sqrt(squares / count), 0.3) << "levels";
}

TEST(SmoothFilling, AConstantStaysConstant) {
  const Image<Eigen::Array3f> picture = fill(
      37, 41, [](int x, int y) { return (x * 7 + y * 13) % 5 != 0; },
      [](int, int) -> Eigen::Array3f {
        return {10, 200, 77};
      });
  for (int y = 0; y < 41; ++y) {
    for (int x = 0; x < 37; ++x) {
      if ((x * 7 + y * 13) % 5 == 0) continue;
      ASSERT_LT((picture(x, y) - Eigen::Array3f(10, 200, 77)).abs().maxCoeff(), 0.01F);
    }
  }
}

// Its border is free: what is beyond does not pull.
TEST(SmoothFilling, ReachesWhatHangsTogetherWithNothingKnown) {
  const auto is_open = [](int x, int) { return x != 5; };
  const Image<Eigen::Array3f> picture = fill(64, 16, is_open, [](int, int) -> Eigen::Array3f {
    return {50, 60, 70};
  });
  EXPECT_NEAR(picture(63, 15)[0], 50, 0.01F);
  EXPECT_NEAR(picture(0, 0)[2], 70, 0.01F);
}

// Rows are shared in bands of the box, which begin elsewhere if something far above is open, too.
TEST(SmoothFilling, BandsLeaveNoTrace) {
  constexpr int width = 200;
  constexpr int height = 460;
  const auto color = [](int x, int y) -> Eigen::Array3f {
    return {static_cast<float>((x * 37 + y * 91) % 256), static_cast<float>((x * y) % 256),
            static_cast<float>((x + 2 * y) % 256)};
  };
  const auto hole = [](int x, int y) {
    return std::hypot(x - 100, y - 280) < 95 + 20 * std::sin(0.1 * x) && (x * 11 + y * 5) % 23 != 0;
  };
  const Image<Eigen::Array3f> picture = fill(width, height, hole, color, 160);
  for (const int above : {30, 101, 130}) {
    const Image<Eigen::Array3f> other = fill(
        width, height, [&](int x, int y) { return hole(x, y) || (x == 100 && y == above); }, color,
        above);
    for (int y = 160; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        ASSERT_TRUE((picture(x, y) == other(x, y)).all()) << above << ": " << x << ", " << y;
      }
    }
  }
}

TEST(SmoothFilling, SaysThatNothingIsKnown) {
  SmoothFilling filling;
  Image<SmoothFilling::Kind>& kinds = filling.begin({0, 0, 4, 4});
  kinds.fill(SmoothFilling::absent);
  kinds(2, 2) = SmoothFilling::open;
  kinds(0, 0) = SmoothFilling::known;  // not beside it
  EXPECT_FALSE(filling.connect([](int, int) -> Eigen::Array3f { return {1, 2, 3}; }));
}

}  // namespace
}  // namespace diminish
