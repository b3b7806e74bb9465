#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "core/channels.h"
#include "diminish/inpainter.h"
#include "inpaint/rim_lines.h"

namespace diminish {
namespace {

constexpr std::uint8_t wall = surface_label::first_plane;
constexpr std::uint8_t table = wall + 1;
constexpr int width = 320;
constexpr int height = 260;
const Eigen::Array3f wall_color{120, 130, 140};
const Eigen::Array3f bar_color{60, 70, 90};

/// The edge through (160, 130); y = 130 + (x - 160) tan(angle).
struct Edge {
  explicit Edge(double degrees)
      : along(std::cos(degrees * M_PI / 180), std::sin(degrees * M_PI / 180)) {}
  /// Positive above it.
  double height(double x, double y) const { return (x - 160) * along.y() - (y - 130) * along.x(); }
  Eigen::Vector2d along;
};

/// A wall with a straight bar in front of it, which an object to remove hides in part.
struct Scene {
  Image<Bgr> truth{width, height};
  Image<Bgr> picture{width, height};
  Mask occlusion{width, height, 0};
  Mask missing{width, height, 0};
  Surfaces surfaces;

  /// The bar's pixels are `share` of the whole, antialiased.
  template <class Share>
  explicit Scene(const Share& share, const Rect& object = {90, 70, 140, 120}) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto bar = static_cast<float>(share(x, y));
        truth(x, y) = to_color(wall_color + bar * (bar_color - wall_color));
      }
    }
    picture = truth;
    occlusion.fill(object, 255);
    missing.fill(object, 255);
    picture.fill(object, {0, 255, 0});
    surfaces.region = picture.bounds();
    surfaces.label.resize(width, height, wall);
  }
  Image<Bgr> fill(const char* method = "structure") const {
    Image<Bgr> filled = picture;
    const auto inpainter = Registry<Inpainter>::get(method)();
    RimLines lines;
    lines.find(picture, occlusion, bounding_box(occlusion));
    EXPECT_TRUE(inpainter->inpaint({missing, occlusion, surfaces, {}, lines.lines()}, {}, filled));
    return filled;
  }
  /// Root mean square, in grey levels, where `part` is missing.
  double error(const Image<Bgr>& filled, const Rect& part) const {
    double squares = 0;
    int count = 0;
    for (int y = part.y; y < part.bottom(); ++y) {
      for (int x = part.x; x < part.right(); ++x) {
        if (missing(x, y) == 0) continue;
        squares += static_cast<double>(
            (to_channels(filled(x, y)) - to_channels(truth(x, y))).square().mean());
        ++count;
      }
    }
    return std::sqrt(squares / count);
  }
};

double clamped(double share) {
  return std::clamp(share, 0.0, 1.0);
}
/// A bar 14 pixels wide.
Scene with_bar(double degrees) {
  const Edge middle(degrees);
  return Scene([&](int x, int y) { return clamped(7.5 - std::abs(middle.height(x, y))); });
}
/// The same, but it ends within the object, at the given x.
Scene with_half_bar(double end) {
  const Edge middle(0);
  return Scene([&](int x, int y) {
    return clamped(7.5 - std::abs(middle.height(x, y))) * clamped(end - x + 0.5);
  });
}

class AtAngle : public ::testing::TestWithParam<double> {};

TEST_P(AtAngle, FindsBothEdgesOfABarOnBothSides) {
  const Scene scene = with_bar(GetParam());
  const Edge middle(GetParam());
  RimLines finder;
  finder.find(scene.picture, scene.occlusion, {90, 70, 140, 120});
  const std::vector<RimLine>& lines = finder.lines();
  ASSERT_EQ(lines.size(), 4U);
  for (const RimLine& line : lines) {
    EXPECT_NEAR(std::abs(middle.height(line.entry.x(), line.entry.y())), 7, 0.3);
    EXPECT_GT(std::abs(line.outward.cast<double>().dot(middle.along)), std::cos(0.006));
    EXPECT_GE(line.length, 40);
    // The normal points at the wall.
    EXPECT_LT((line.profile.front() - bar_color).abs().maxCoeff(), 2);
    EXPECT_LT((line.profile.back() - wall_color).abs().maxCoeff(), 2);
    const int x = static_cast<int>(std::lrint(line.entry.x()));
    const int y = static_cast<int>(std::lrint(line.entry.y()));
    EXPECT_EQ(scene.occlusion(x, y), 0);
    EXPECT_EQ(bounding_box(scene.occlusion),
              intersect(bounding_box(scene.occlusion), grow({x, y, 1, 1}, 200)));
  }
}

TEST_P(AtAngle, JoinsABarThatEntersOnTwoSides) {
  const Scene scene = with_bar(GetParam());
  const Rect object = bounding_box(scene.occlusion);
  const double smooth = scene.error(scene.fill("surfaces"), object);
  EXPECT_GT(smooth, 8);
  // At its ends the bar bleeds into the wall beside it.
  EXPECT_LT(scene.error(scene.fill(), object), smooth / 3);
  const Rect middle{150, 120, 20, 20};
  EXPECT_LT(scene.error(scene.fill(), middle), scene.error(scene.fill("surfaces"), middle) / 5);
}

INSTANTIATE_TEST_SUITE_P(StructureInpainting, AtAngle,
                         ::testing::Values(0., 7., 30., 45., 70., 90., 133., 175.));

// Half of it, as nobody knows whether it goes on.
TEST(StructureInpainting, ContinuesABarThatEntersOnce) {
  const Scene scene = with_half_bar(200);
  const Image<Bgr> filled = scene.fill();
  const float smooth = to_channels(scene.fill("surfaces")(150, 130))[0];
  EXPECT_GT(smooth, 110);
  EXPECT_LT(to_channels(filled(130, 124))[0], smooth - 12);
  EXPECT_LT(to_channels(filled(150, 124))[0], smooth - 12);
  EXPECT_NEAR(to_channels(filled(150, 90))[0], smooth, 12) << "beside it";
}

TEST(StructureInpainting, EndsABarWhereAnotherPlaneBegins) {
  Scene scene = with_half_bar(150);
  scene.surfaces.label.fill({130, 0, width - 130, height}, table);
  const Image<Bgr> filled = scene.fill();
  const Image<Bgr> smooth = scene.fill("surfaces");
  EXPECT_NE(filled(120, 124), smooth(120, 124));
  for (int y = 70; y < 190; ++y) {
    for (int x = 135; x < 230; ++x) ASSERT_EQ(filled(x, y), smooth(x, y)) << x << ' ' << y;
  }
}

TEST(StructureInpainting, EndsABarBehindWhatIsSeen) {
  Scene scene = with_half_bar(150);
  scene.missing.fill({130, 100, 20, 60}, 0);
  const Image<Bgr> filled = scene.fill();
  const Image<Bgr> smooth = scene.fill("surfaces");
  EXPECT_NE(filled(120, 124), smooth(120, 124));
  for (int y = 70; y < 190; ++y) {
    for (int x = 130; x < 230; ++x) ASSERT_EQ(filled(x, y), smooth(x, y)) << x << ' ' << y;
  }
}

// It was measured, and would have been measured further inside, too.
TEST(StructureInpainting, DoesNotContinueAThingInFront) {
  Scene scene = with_half_bar(100);
  for (int y = 123; y < 138; ++y) {
    for (int x = 0; x < 90; ++x) scene.surfaces.label(x, y) = surface_label::foreground;
  }
  EXPECT_EQ(scene.fill(), scene.fill("surfaces"));
}

TEST(StructureInpainting, IsSmoothWhereNothingIsToBeContinued) {
  Scene scene([](int, int) { return 0; });
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, 4);
  for (Bgr& pixel : scene.picture) {
    const float shift = noise(random);
    pixel = to_color(to_channels(pixel) + shift);
  }
  EXPECT_EQ(scene.fill(), scene.fill("surfaces"));
}

TEST(StructureInpainting, ChangesOnlyWhatIsMissing) {
  Scene scene = with_bar(30);
  scene.missing.fill({150, 90, 25, 80}, 0);  // seen
  const Image<Bgr> filled = scene.fill();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (scene.missing(x, y) == 0) {
        ASSERT_EQ(filled(x, y), scene.picture(x, y));
      }
    }
  }
}

// What an object hides must not matter.
TEST(StructureInpainting, ReadsNothingInsideTheMask) {
  const Scene scene = with_bar(30);
  Scene other = with_bar(30);
  std::mt19937 random(6);
  for (int y = 70; y < 190; ++y) {
    for (int x = 90; x < 230; ++x) {
      const auto level = [&] { return static_cast<std::uint8_t>(random()); };
      other.picture(x, y) = {level(), level(), level()};
    }
  }
  EXPECT_EQ(scene.fill(), other.fill());
}

TEST(StructureInpainting, DoesNotDependOnThreads) {
  const Scene scene = with_bar(30);
  oneapi::tbb::task_arena one(1);
  oneapi::tbb::task_arena four(4);
  Image<Bgr> alone;
  Image<Bgr> shared;
  one.execute([&] { alone = scene.fill(); });
  four.execute([&] { shared = scene.fill(); });
  EXPECT_EQ(alone, shared);
}

TEST(StructureInpainting, TakesObjectsAtThePicturesEdge) {
  const Edge middle(10);
  const auto bar = [&](int x, int y) { return clamped(7.5 - std::abs(middle.height(x, y))); };
  for (const Rect& object : {Rect{0, 0, 140, height}, Rect{200, 60, 120, 140},
                             Rect{0, 0, width, 150}, Rect{3, 3, width - 6, height - 6}}) {
    const Scene scene(bar, object);
    const Image<Bgr> filled = scene.fill();
    EXPECT_LT(scene.error(filled, object), scene.error(scene.fill("surfaces"), object) + 2);
  }
}

}  // namespace
}  // namespace diminish
