#include "scene/color_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "composite/map_colors.h"
#include "diminish/color_corrector.h"
#include "scene/color_maps.h"

namespace diminish {
namespace {

const Rect bounds{0, 0, 640, 480};

ColorMap some_map() {
  ColorMap map;
  map.matrix << 0.85F, 0.02F, -0.01F, 0.03F, 1.04F, 0.F, -0.02F, 0.01F, 1.2F;
  map.offset = {3, -4, 6};
  map.field << 0.05F, -0.03F, -0.12F, 0.02F, -0.08F;
  map.center = {319.5F, 239.5F};
  map.half_width = 320;
  return map;
}

/// What two cameras see of surfaces of many colours; `wrong` of 100 pairs show different surfaces.
std::vector<ColorPair> pairs_of(const ColorMap& map, int count, unsigned wrong) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> level(30, 180);
  std::normal_distribution<float> noise(0, 0.8F);
  std::vector<ColorPair> pairs;
  for (int i = 0; i < count; ++i) {
    ColorPair pair;
    pair.pixel = {static_cast<float>(random() % 640), static_cast<float>(random() % 480)};
    pair.rgbd = {level(random), level(random), level(random)};
    pair.camera = map(pair.rgbd, pair.pixel.x(), pair.pixel.y());
    for (int c = 0; c < 3; ++c) pair.camera[c] += noise(random);
    if (random() % 100 < wrong) pair.camera = {level(random), level(random), level(random)};
    pairs.push_back(pair);
  }
  return pairs;
}

float worst_difference(const ColorMap& a, const ColorMap& b) {
  float worst = 0;
  for (float y = 0; y < 480; y += 40) {
    for (float x = 0; x < 640; x += 40) {
      for (const Eigen::Array3f& color :
           {Eigen::Array3f(40, 60, 170), Eigen::Array3f(120, 120, 120),
            Eigen::Array3f(170, 50, 30)}) {
        worst = std::max(worst, (a(color, x, y) - b(color, x, y)).abs().maxCoeff());
      }
    }
  }
  return worst;
}

TEST(ColorMap, FindsTheMapAmongWrongPairs) {
  const ColorMap map = some_map();
  for (const unsigned wrong : {0U, 30U}) {
    const ColorMap found =
        ColorMapFit().fit(pairs_of(map, 3000, wrong), ColorMapModel::field, bounds);
    EXPECT_LT(worst_difference(found, map), 1.5F) << wrong << " % wrong";
  }
}

TEST(ColorMap, AffineFindsGainsAndOffsets) {
  ColorMap map = some_map();
  map.field.setZero();
  map.matrix = map.matrix.diagonal().asDiagonal();
  const ColorMap found = ColorMapFit().fit(pairs_of(map, 2000, 30), ColorMapModel::affine, bounds);
  EXPECT_LT(worst_difference(found, map), 1.F);
  EXPECT_EQ(found.field.norm(), 0);
}

TEST(ColorMap, ChangesNothingWithoutPairsAndLittleForUnseenColorsWithFew) {
  EXPECT_LT(worst_difference(ColorMapFit().fit({}, ColorMapModel::field, bounds), ColorMap{}),
            1e-4F);
  // Three grey surfaces in one place say nothing about colours or the field.
  std::vector<ColorPair> pairs;
  for (const float level : {80.F, 100.F, 120.F}) {
    pairs.push_back(
        {{300, 200}, Eigen::Array3f::Constant(level), Eigen::Array3f::Constant(1.1F * level)});
  }
  const ColorMap found = ColorMapFit().fit(pairs, ColorMapModel::field, bounds);
  const Eigen::Array3f red(30, 30, 200);
  EXPECT_LT((found(red, 300, 200) - 1.1F * red).abs().maxCoeff(), 25);
  EXPECT_LT((found(Eigen::Array3f::Constant(100.F), 10, 10) - 110).abs().maxCoeff(), 20);
}

/// A reconstruction of two cameras next to each other, with gaps.
struct Picture {
  Reconstruction reconstruction;
  Mask occlusion;
  Image<Bgr> picture;

  Picture() : occlusion(83, 40, 0), picture(83, 40, {1, 2, 3}) {
    std::mt19937 random(3);
    reconstruction.region = Rect{3, 2, 79, 37};
    reconstruction.color.resize(83, 40);
    reconstruction.source.resize(83, 40);
    for (std::size_t i = 0; i < picture.size(); ++i) {
      const auto level = [&] { return static_cast<std::uint8_t>(random()); };
      const auto source = static_cast<std::uint8_t>(random() % 3);
      reconstruction.source.data()[i] = source;
      if (source != 0) reconstruction.color.data()[i] = {level(), level(), level(), 255};
      occlusion.data()[i] = random() % 4 == 0 ? 0 : 255;
    }
  }

  /// Some pixels are seen by the other camera, too.
  void add_second_view() {
    std::mt19937 random(4);
    SecondView& second = reconstruction.second;
    second.color.resize(83, 40, {});
    second.source.resize(83, 40, 0);
    second.share.resize(83, 40, 0);
    for (std::size_t i = 0; i < picture.size(); ++i) {
      if (reconstruction.source.data()[i] == 0 || random() % 2 == 0) continue;
      const auto level = [&] { return static_cast<std::uint8_t>(random()); };
      second.color.data()[i] = {level(), level(), level(), 255};
      second.source.data()[i] = static_cast<std::uint8_t>(3 - reconstruction.source.data()[i]);
      second.share.data()[i] = static_cast<std::uint8_t>(1 + random() % 128);
    }
  }
};

// The vectorised rows against the map's own formula.
void expect_mapped(const Picture& p) {
  const Rect& region = p.reconstruction.region;
  std::vector<ColorMap> maps(256);
  maps[1] = some_map();
  maps[2].matrix *= 0.7F;
  constexpr int cell = SoftMembrane::cell;
  std::vector<SoftMembrane::Node> correction;
  for (int i = 0; i < region.width / cell + 2; ++i) {
    const auto level = static_cast<float>(3 * i % 9);
    correction.emplace_back(level - 4, 5 - level, 2 * level - 8, 0.F);
  }
  Image<Bgr> mapped = p.picture;
  for (int y = region.y; y < region.bottom(); ++y) {
    map_colors(maps, p.reconstruction, p.occlusion, y, correction.data(), mapped);
  }
  int changed = 0;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 83; ++x) {
      const std::uint8_t source = p.reconstruction.source(x, y);
      if (!region.contains(x, y) || p.occlusion(x, y) == 0 || source == 0) {
        ASSERT_EQ(mapped(x, y), p.picture(x, y));
        continue;
      }
      ++changed;
      const auto map = [&](std::uint8_t by, const Bgra& c) -> Eigen::Array3f {
        return maps[by](Eigen::Array3f(c.b, c.g, c.r), static_cast<float>(x),
                        static_cast<float>(y));
      };
      Eigen::Array3f expected = map(source, p.reconstruction.color(x, y));
      const SecondView& second = p.reconstruction.second;
      const float share = second.share.empty() ? 0 : second.share(x, y) / 255.F;
      Eigen::Array3f other = expected;
      if (share > 0) other = map(second.source(x, y), second.color(x, y));
      for (int k = 0; k < 3; ++k) {
        const auto node = static_cast<std::size_t>((x - region.x) / cell);
        const float added = std::lerp(correction[node][k], correction[node + 1][k],
                                      static_cast<float>((x - region.x) % cell) / cell);
        expected[k] += added;
        other[k] += added;
      }
      expected = expected.max(0.F).min(255.F);
      expected += share * (other.max(0.F).min(255.F) - expected);
      // A mixture is of levels, and rounded once more.
      const float rounding = share > 0 ? 1.01F : 0.51F;
      EXPECT_NEAR(mapped(x, y).b, expected[0], rounding);
      EXPECT_NEAR(mapped(x, y).g, expected[1], rounding);
      EXPECT_NEAR(mapped(x, y).r, expected[2], rounding);
    }
  }
  EXPECT_GT(changed, 1000);
}

TEST(MapColors, DoesWhatTheMapSays) {
  expect_mapped(Picture());
}

TEST(MapColors, MixesTwoCamerasOnceEachIsMapped) {
  Picture p;
  p.add_second_view();
  expect_mapped(p);
}

/// A scene in which the RGB-D camera sees everything darker and bluer than the colour camera.
struct TwoLooks {
  Image<Bgr> camera{400, 300};
  Mask occlusion{400, 300, 0};
  Reconstruction reconstruction;
  std::vector<SceneSample> samples;

  static Bgr color(int x, int y) {
    return {static_cast<std::uint8_t>(90 + 40 * ((x / 40) % 3)),
            static_cast<std::uint8_t>(80 + 35 * ((y / 30) % 3)),
            static_cast<std::uint8_t>(70 + 30 * ((x / 40 + y / 30) % 4))};
  }
  static Bgr as_rgbd_sees(const Bgr& c) {
    const auto level = [](double value) { return static_cast<std::uint8_t>(std::lrint(value)); };
    return {level(0.9 * c.b + 20), level(0.8 * c.g), level(0.6 * c.r + 3)};
  }

  TwoLooks() {
    reconstruction.region = Rect{100, 80, 200, 140};
    reconstruction.color.resize(400, 300);
    reconstruction.source.resize(400, 300);
    occlusion.fill({120, 100, 160, 100}, 255);
    for (int y = 0; y < 300; ++y) {
      for (int x = 0; x < 400; ++x) {
        const Bgr seen = as_rgbd_sees(color(x, y));
        camera(x, y) = color(x, y);
        if (occlusion(x, y) != 0) camera(x, y) = {255, 0, 255};
        if (reconstruction.region.contains(x, y)) {
          reconstruction.color(x, y) = {seen.b, seen.g, seen.r, 255};
          reconstruction.source(x, y) = 1;
        }
        if (x % 5 != 2 || y % 5 != 2) continue;
        SceneSample sample;
        sample.pixel = {static_cast<float>(x), static_cast<float>(y)};
        sample.color = seen;
        sample.source = 1;
        sample.even = true;
        samples.push_back(sample);
      }
    }
  }
  Image<Bgr> corrected(const char* method) const {
    Image<Bgr> picture = camera;
    const auto corrector = Registry<ColorCorrector>::get(method)();
    ColorMaps maps;
    maps.fit(camera, occlusion, samples, corrector->declaration().maps);
    corrector->correct({camera, occlusion, reconstruction, maps.by_source()}, picture);
    return picture;
  }
  /// Levels, inside the mask.
  double worst_error(const char* method) const {
    const Image<Bgr> picture = corrected(method);
    double worst = 0;
    for (int y = 0; y < 300; ++y) {
      for (int x = 0; x < 400; ++x) {
        const Bgr exact = color(x, y);
        const Bgr& shown = picture(x, y);
        worst =
            std::max({worst, std::abs(double(exact.b) - shown.b),
                      std::abs(double(exact.g) - shown.g), std::abs(double(exact.r) - shown.r)});
      }
    }
    return worst;
  }
};

TEST(MappedCorrection, ShowsWhatTheColorCameraWouldHaveSeen) {
  const TwoLooks looks;
  EXPECT_GT(looks.worst_error("none"), 20);
  for (const char* method : {"affine", "affine_membrane", "field", "field_membrane"}) {
    EXPECT_LE(looks.worst_error(method), 2) << method;
  }
}

// An error only at the mask's rim (a shadow, a depth edge) must not reach the inside.
TEST(MappedCorrection, IsNotDrawnAlongByTheRim) {
  TwoLooks looks;
  for (int x = 100; x < 300; ++x) {
    for (int y = 201; y < 220; ++y) looks.camera(x, y) = {10, 12, 14};
  }
  const Image<Bgr> picture = looks.corrected("field_membrane");
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 400; ++x) {
      if (looks.occlusion(x, y) != 0) continue;
      ASSERT_EQ(picture(x, y), looks.camera(x, y)) << "it stays";
    }
  }
  for (int x = 130; x < 270; ++x) {
    const Bgr exact = TwoLooks::color(x, 195);
    EXPECT_NEAR(picture(x, 195).g, exact.g, 3) << x;
  }
}

}  // namespace
}  // namespace diminish
