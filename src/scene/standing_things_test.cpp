#include "scene/standing_things.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "analytic_scene.h"
#include "diminish/diminished_frame.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

/// The scene's wall is a table here, for cameras that look along it; z is up.
const Eigen::Vector3d user(0.45, -0.9, 0.5);
const Eigen::Vector3d other(-0.8, -0.6, 0.36);

/// A box on the table, seen from the left; the user, on the right, would see another side of it.
class OnATable : public ::testing::Test {
 protected:
  void set_up(const AnalyticScene& scene) {
    const AnalyticFrame seen(scene, {other}, LensModel::plumb_bob, user);
    const Intrinsics& color = seen.rig.color;
    const RigidTransform& color_from_world = *seen.poses.color_from_world;
    reconstruction.region = color.bounds();
    reconstruction.depth_m.resize(color.width, color.height);
    reconstruction.source.resize(color.width, color.height);
    surfaces.region = color.bounds();
    surfaces.label.resize(color.width, color.height);
    side_m.resize(color.width, color.height);
    const auto depth_in_picture = [&](const Eigen::Vector3d& point) {
      return static_cast<float>((color_from_world * point).z());
    };
    scene.render(Lens(color), color_from_world, [&](int x, int y, const AnalyticScene::Hit& hit) {
      const AnalyticScene::Hit first = scene.cast(other, hit.point - other);
      const bool is_seen = (first.point - hit.point).norm() < 1e-3;
      const float z = depth_in_picture(hit.point);
      reconstruction.depth_m(x, y) = is_seen ? z : 0;
      const std::uint8_t source = hit.on_box ? box_source : std::uint8_t{1};
      reconstruction.source(x, y) = is_seen ? source : std::uint8_t{0};
      surfaces.label(x, y) =
          is_seen && hit.on_box ? surface_label::foreground : surface_label::first_plane;
      side_m(x, y) = !is_seen && hit.on_box ? z : 0;
    });
    if (has_slit) open_slit();
    OcclusionMasks masks = testing::empty_masks(seen.rig);
    masks.color.fill(255);
    const Eigen::Vector3d normal = color_from_world.rotation * Eigen::Vector3d::UnitZ();
    const std::vector<BackgroundPlane> planes{
        {normal.cast<float>(), static_cast<float>(normal.dot(color_from_world.translation))}};
    before = surfaces.label;
    const Surfaces labelled = surfaces;
    StandingThings(seen.rig).find(
        {seen.frame, seen.poses, masks, color.bounds(), reconstruction, planes}, labelled,
        surfaces);
  }
  /// Beside the side that nobody sees, and above that through the top, another thing shows through
  /// the box, far behind it.
  void open_slit() {
    constexpr int width_px = 3;
    constexpr float further_m = 0.18F;
    for (int y = side_m.height() - 1, side = 0; y >= 0; --y) {
      const float* const own = side_m.row(y);
      const float* const found =
          std::find_if(own, own + side_m.width(), [](float z) { return z != 0; });
      const bool has_side = found != own + side_m.width();
      if (has_side) side = static_cast<int>(found - own);
      for (int x = std::max(0, side - width_px); x < side; ++x) {
        if (surfaces.label(x, y) != surface_label::foreground) continue;
        if (has_side) slit.push_back({x, y, reconstruction.depth_m(x, y)});
        reconstruction.depth_m(x, y) += further_m;
      }
    }
  }
  int count_standing() const {
    int count = 0;
    for (const std::uint8_t label : surfaces.label) {
      count += label == surface_label::standing ? 1 : 0;
    }
    return count;
  }

  std::uint8_t box_source = 1;
  bool has_slit = false;
  struct SlitPixel {
    int x, y;
    float box_m;  ///< the box's z
  };
  std::vector<SlitPixel> slit;
  Reconstruction reconstruction;
  Surfaces surfaces;
  Image<std::uint8_t> before;
  Image<float> side_m;  ///< z of the box where only the user would see it
};

// Against the ray caster.
TEST_F(OnATable, FindsTheSideThatOnlyTheUserWouldSee) {
  AnalyticScene scene;
  scene.box_min.z() = 0;
  scene.box_max.z() = 0.2;
  set_up(scene);
  int both = 0;
  int either = 0;
  double error_m = 0;
  for (int y = 0; y < side_m.height(); ++y) {
    for (int x = 0; x < side_m.width(); ++x) {
      const bool is_side = side_m(x, y) != 0;
      const bool found = surfaces.label(x, y) == surface_label::standing;
      both += is_side && found ? 1 : 0;
      either += is_side || found ? 1 : 0;
      if (is_side && found) error_m += std::abs(surfaces.standing_depth_m(x, y) - side_m(x, y));
    }
  }
  ASSERT_GT(either, 400);
  EXPECT_GT(both, 0.75 * either);
  EXPECT_LT(error_m / both, 0.015);
}

TEST_F(OnATable, HasNoSlitThroughWhichAnotherThingShows) {
  AnalyticScene scene;
  scene.box_min.z() = 0;
  scene.box_max.z() = 0.2;
  has_slit = true;
  set_up(scene);
  ASSERT_GT(slit.size(), 100U);
  int closed = 0;
  for (const SlitPixel& pixel : slit) {
    const bool is_side = surfaces.label(pixel.x, pixel.y) == surface_label::standing;
    const float off_m = surfaces.standing_depth_m(pixel.x, pixel.y) - pixel.box_m;
    closed += is_side && std::abs(off_m) < 0.05F ? 1 : 0;
  }
  EXPECT_GT(closed, 0.8 * static_cast<double>(slit.size()));
}

TEST_F(OnATable, ABoxThatIsOnlyRememberedHidesNothing) {
  AnalyticScene scene;
  scene.box_min.z() = 0;
  scene.box_max.z() = 0.2;
  box_source = provenance::remembered;
  set_up(scene);
  EXPECT_EQ(count_standing(), 0);
}

// The RGB-D camera looks through below it.
TEST_F(OnATable, ABoxInTheAirHasNothingBelow) {
  AnalyticScene scene;
  scene.box_min.z() = 0.17;
  scene.box_max.z() = 0.2;
  set_up(scene);
  EXPECT_EQ(count_standing(), 0);
}

TEST_F(OnATable, AnEmptyTableStaysAsItIs) {
  AnalyticScene scene;
  scene.has_box = false;
  set_up(scene);
  EXPECT_EQ(count_standing(), 0);
  EXPECT_TRUE(std::equal(before.begin(), before.end(), surfaces.label.begin()));
}

}  // namespace
}  // namespace diminish
