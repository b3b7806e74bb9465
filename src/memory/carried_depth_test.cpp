#include "memory/carried_depth.h"

#include <gtest/gtest.h>

#include "analytic_scene.h"

namespace diminish {
namespace {

/// A wall 2 m away with stripes that are 10 cm wide, seen by a camera that moves along it.
class Carried : public ::testing::Test {
 protected:
  static constexpr float wall_m = 2;
  static constexpr Rect patch{200, 100, 40, 40};  ///< in the picture

  struct View {
    double x_m = 0;             ///< where the camera is
    Rect measured = {};         ///< on the grid
    bool is_hidden = false;     ///< the patch, by an object to remove
    bool is_repainted = false;  ///< the patch
    float measured_m = wall_m;
  };
  const Image<float>& fill(const View& view) {
    const Rect bounds = grid.intrinsics().bounds();
    RigidTransform color_from_world;
    color_from_world.translation.x() = -view.x_m;
    Image<Bgr> picture(bounds.width, bounds.height);
    inverse_depth.resize(bounds.width, bounds.height, 0);
    inverse_depth.fill(view.measured, 1 / view.measured_m);
    for (int y = 0; y < bounds.height; ++y) {
      for (int x = 0; x < bounds.width; ++x) {
        const double on_wall = view.x_m + static_cast<double>(grid.ray(x, y).x()) * wall_m;
        const bool is_dark = std::fmod(on_wall + 10, 0.2) < 0.1;
        picture(x, y) = is_dark ? Bgr{20, 30, 90} : Bgr{200, 180, 60};
        if (view.is_repainted && on_grid(patch).contains(x, y)) picture(x, y) = {20, 220, 20};
      }
    }
    Mask objects(rig.color.width, rig.color.height, std::uint8_t{0});
    if (view.is_hidden) objects.fill(patch, 255);
    carried.fill(color_from_world, picture, objects, inverse_depth);
    return inverse_depth;
  }
  Rect on_grid(const Rect& part) const {
    const int step = grid.step();
    return {part.x / step, part.y / step, part.width / step, part.height / step};
  }
  /// The share of places in a part that have the wall's depth.
  double share(const Image<float>& filled, const Rect& part) const {
    int count = 0;
    for (int y = part.y; y < part.bottom(); ++y) {
      for (int x = part.x; x < part.right(); ++x) {
        count += std::abs(filled(x, y) * wall_m - 1) < 0.001F ? 1 : 0;
      }
    }
    return count / static_cast<double>(part.width * part.height);
  }

  const Rig rig = testing::small_rig();
  const KeyframeGrid grid{rig.color};
  const Rect everywhere = grid.intrinsics().bounds();
  CarriedDepth carried{grid};
  Image<float> inverse_depth;
};

TEST_F(Carried, StaysWhereNothingIsMeasuredAnyMore) {
  EXPECT_EQ(share(fill({}), everywhere), 0);
  fill({.measured = everywhere});
  const Rect middle = grow(everywhere, -everywhere.width / 8);
  EXPECT_GT(share(fill({.x_m = 0.05}), middle), 0.9);
  EXPECT_GT(share(fill({.x_m = 0.1}), middle), 0.9);
}

TEST_F(Carried, IsNotShownWhereThePictureHasChanged) {
  fill({.measured = everywhere});
  EXPECT_EQ(share(fill({.is_repainted = true}), grow(on_grid(patch), -1)), 0);
  EXPECT_EQ(share(fill({}), grow(on_grid(patch), -1)), 0);
}

TEST_F(Carried, IsKeptUnderTheObjectsAndNotShown) {
  fill({.measured = everywhere});
  EXPECT_EQ(share(fill({.is_hidden = true}), on_grid(patch)), 0);
  EXPECT_GT(share(fill({}), on_grid(patch)), 0.9);
}

TEST_F(Carried, GivesWayToWhatIsMeasuredUnderTheObjects) {
  fill({.measured = everywhere});
  fill({.measured = everywhere, .is_hidden = true, .measured_m = 2.5F});
  EXPECT_EQ(share(fill({}), on_grid(patch)), 0);
}

TEST_F(Carried, ForgetsWhenTold) {
  fill({.measured = everywhere});
  carried.forget();
  EXPECT_EQ(share(fill({}), everywhere), 0);
}

}  // namespace
}  // namespace diminish
