#include "composite/shadow_gain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "diminish/diminished_frame.h"
#include "lit_wall.h"
#include "scene/cast_shadows.h"

namespace diminish {
namespace {

/// The wall as the user's camera sees it, with some texture, and the object's shadow on it as it is
/// found from an RGB-D camera's samples. The truth is the ray caster's.
class LampsInPicture : public ::testing::Test, protected testing::LitWall {
 protected:
  LampsInPicture() {
    shadows.find({plane}, samples, box_points);
    shadows.shade(wall(), surfaces);
    render(1);
  }
  /// share: of the true shadow's depth.
  void render(double share) {
    const auto seen = [&](auto& at, std::uint8_t origin) {
      return [&at, origin](int x, int y, const testing::AnalyticScene::Hit& hit) {
        if (hit.on_box) at(x, y) = origin;
      };
    };
    scene.render(lens, color_from_world, seen(provenance, provenance::inpainted));
    testing::AnalyticScene empty = scene;
    empty.has_box = false;
    empty.render(lens, color_from_world, [&](int x, int y, const testing::AnalyticScene::Hit& hit) {
      truth(x, y) = 1 - share * (1 - light_at(hit.point));
      const double texture = 1 + 0.06 * std::sin(40 * hit.point.x() + 3 * hit.point.y());
      const double level = 130 * (1 + 0.2 * hit.point.x()) * texture * truth(x, y);
      const auto whole = static_cast<std::uint8_t>(std::lround(level));
      picture(x, y) = {whole, whole, whole};
    });
    for (SceneSample& sample : samples) {
      const auto pixel = lens.project(sample.point_m.cast<double>());
      sample.pixel = pixel ? pixel->cast<float>() : Eigen::Vector2f(-1, -1);
    }
  }
  void apply() { ShadowGain().apply({picture, provenance, shadows.shadows(), samples}, surfaces); }
  /// The light's mean error in the region where the user's camera sees the wall and it is not fully
  /// lit, in truth or as found.
  double error(std::uint8_t origin) const {
    double sum = 0;
    int count = 0;
    const Rect& region = surfaces.region;
    for (int y = region.y; y < region.bottom(); ++y) {
      for (int x = region.x; x < region.right(); ++x) {
        const double light = surfaces.light(x, y).g / 255.0;
        if (provenance(x, y) != origin || std::min(light, truth(x, y)) > 0.98) continue;
        sum += std::abs(light - truth(x, y));
        ++count;
      }
    }
    return count > 0 ? sum / count : 0;
  }

  const Lens lens{rig.color};
  CastShadows shadows{rig.color};
  Surfaces surfaces = wall_surfaces();
  Image<Bgr> picture{rig.color.width, rig.color.height};
  Image<std::uint8_t> provenance{rig.color.width, rig.color.height, provenance::camera};
  Image<double> truth{rig.color.width, rig.color.height, 1.0};
};

TEST_F(LampsInPicture, LightBecomesThatOfTheRayCaster) {
  const double before = error(provenance::camera);
  const double before_inside = error(provenance::inpainted);
  ASSERT_GT(before, 0.03);
  apply();
  EXPECT_LT(error(provenance::camera), 0.7 * before) << before;
  EXPECT_LT(error(provenance::inpainted), 0.7 * before_inside) << before_inside;
}

TEST_F(LampsInPicture, AFainterShadowIsLiftedLess) {
  for (const double share : {0.0, 0.4}) {
    surfaces = wall_surfaces();
    shadows.shade(wall(), surfaces);
    render(share);
    const double before = error(provenance::camera);
    apply();
    EXPECT_LT(error(provenance::camera), 0.2 * before) << share << ' ' << before;
  }
}

TEST_F(LampsInPicture, SamplesShowThePlaneBeyondTheRegion) {
  // All of it is shaded.
  surfaces.region = {90, 130, 80, 70};
  const double before = error(provenance::camera);
  const Image<Bgr> shaded = surfaces.light;
  std::vector<SceneSample> all;
  all.swap(samples);
  apply();
  EXPECT_EQ(surfaces.light, shaded);
  samples.swap(all);
  apply();
  EXPECT_LT(error(provenance::camera), 0.8 * before) << before;
}

TEST_F(LampsInPicture, OtherLabelsAndOtherPixelsStay) {
  const Rect thing{60, 60, 80, 90};
  for (int y = thing.y; y < thing.bottom(); ++y) {
    std::fill_n(surfaces.label.row(y) + thing.x, thing.width, surface_label::foreground);
  }
  surfaces.region = {40, 20, 223, 219};
  const Image<Bgr> before = surfaces.light;
  apply();
  std::size_t changed = 0;
  for (int y = 0; y < before.height(); ++y) {
    for (int x = 0; x < before.width(); ++x) {
      if (!surfaces.region.contains(x, y) || thing.contains(x, y)) {
        ASSERT_EQ(surfaces.light(x, y), before(x, y)) << x << ' ' << y;
      }
      changed += surfaces.light(x, y) == before(x, y) ? 0U : 1U;
    }
  }
  EXPECT_GT(changed, 1000U);
}

}  // namespace
}  // namespace diminish
