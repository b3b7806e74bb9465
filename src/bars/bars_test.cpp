#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "bar_scene.h"
#include "picture_difference.h"

namespace diminish {
namespace {

using testing::AnalyticScene;

using Bars = testing::BarScene;

// Against the ray caster.
TEST_F(Bars, APipeIsFoundWhereItIs) {
  look();
  const auto& bars = find();
  ASSERT_EQ(bars.size(), 1U);
  EXPECT_TRUE(bars[0].goes_on);
  expect_where_it_is(bars[0]);
}

TEST_F(Bars, APipeIsDrawnAsTheUserWouldSeeIt) {
  look();
  const double before = testing::psnr_db(result.picture, seen->frame.color.own(), masks.color);
  paint();
  EXPECT_GT(testing::psnr_db(result.picture, seen->frame.color.own(), masks.color), before + 6);
  const std::size_t drawn = count(provenance::estimated, true);
  EXPECT_GT(drawn, 9 * count(provenance::inpainted, true));
  EXPECT_LT(count(provenance::estimated, false), drawn / 10);
  const FrameReport& report = result.report;
  EXPECT_EQ(report.estimated_pixels, drawn + count(provenance::estimated, false));
  EXPECT_EQ(report.valid_pixels, report.estimated_pixels);
  EXPECT_EQ(report.valid_pixels + report.missing_pixels, report.mask_pixels);
}

// On vector instructions as one by one.
TEST_F(Bars, PlacesOfManyPointsAreThoseOfEach) {
  look();
  find();
  std::array<int, 4> counts{};
  for (int y = 60; y < 180; y += 7) {
    std::array<float, DepthView::few> ray_x, ray_y, z_m;
    for (int i = 0; i < DepthView::few; ++i) {
      const Eigen::Vector3f ray =
          views->ray(Eigen::Vector2f(static_cast<float>(18 * i + 2), static_cast<float>(y)));
      const auto at = static_cast<std::size_t>(i);
      ray_x[at] = ray.x();
      ray_y[at] = ray.y();
      z_m[at] = i % 5 == 4 ? 0 : 0.85F + 0.05F * static_cast<float>(i % 3);
    }
    BarViews::Places places;
    views->look_at({ray_x.data(), ray_y.data(), z_m.data(), DepthView::few}, places);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Eigen::Vector3f point(z_m[i] * ray_x[i], z_m[i] * ray_y[i], z_m[i]);
      EXPECT_EQ(places[i], views->look_at(point)) << i << " in row " << y;
      ++counts[static_cast<std::size_t>(places[i])];
    }
  }
  for (const auto place :
       {BarViews::Place::bare, BarViews::Place::seen, BarViews::Place::unknown}) {
    EXPECT_GT(counts[static_cast<std::size_t>(place)], 0);
  }
}

TEST_F(Bars, WhatDepthSensorsSeeIsNone) {
  look(true);
  EXPECT_TRUE(find().empty());
}

TEST_F(Bars, AStripePrintedOnTheWallIsNone) {
  scene.box_min.z() = -0.02;
  scene.box_max.z() = 1e-4;
  look(true);
  EXPECT_TRUE(find().empty());
}

// A window, or a wall that is too far away.
TEST_F(Bars, AWideHoleInTheDepthImageIsNone) {
  look();
  Image<std::uint16_t> depth(seen->rig.rgbd[0].depth.width, seen->rig.rgbd[0].depth.height,
                             std::uint16_t{0});
  seen->frame.rgbd[0].depth = depth;
  EXPECT_TRUE(find().empty());
}

TEST_F(Bars, NoneIsWhereTheRgbdCamerasPictureShowsNoEdges) {
  look();
  const Image<Bgr> even(seen->rig.rgbd[0].color.width, seen->rig.rgbd[0].color.height,
                        Bgr{90, 90, 90});
  seen->frame.rgbd[0].color = even;
  EXPECT_TRUE(find().empty());
}

TEST_F(Bars, WhatStandsInFrontHidesIt) {
  look();
  result.reconstruction.region = seen->rig.color.bounds();
  result.reconstruction.depth_m = Image<float>(on_bar.width(), on_bar.height(), 0.6F);
  paint();
  EXPECT_EQ(search.bars().size(), 1U);
  EXPECT_EQ(result.report.estimated_pixels, 0U);
}

TEST_F(Bars, WhatTheUsersCameraHasSeenStays) {
  look();
  for (std::uint8_t& origin : result.provenance) {
    if (origin == provenance::inpainted) origin = provenance::remembered;
  }
  paint();
  EXPECT_EQ(search.bars().size(), 1U);
  EXPECT_EQ(result.report.estimated_pixels, 0U);
}

// It ends where an RGB-D camera sees the wall instead: here, in the middle.
TEST_F(Bars, ABrokenPipeEnds) {
  look();
  AnalyticScene without = scene;
  without.has_box = false;
  const RgbdCamera& camera = seen->rig.rgbd[0];
  Image<std::uint16_t> depth;
  copy(seen->frame.rgbd[0].depth.view(), depth);
  without.render(Lens(camera.depth), *seen->poses.depth_from_world[0],
                 [&](int x, int y, const AnalyticScene::Hit& hit) {
                   if (hit.point.y() > -0.02) return;
                   depth(x, y) = static_cast<std::uint16_t>(std::lrint(
                       (*seen->poses.depth_from_world[0] * hit.point).z() / camera.depth_unit_m));
                 });
  seen->frame.rgbd[0].depth = std::move(depth);
  paint();
  EXPECT_GT(count(provenance::estimated, true), count(provenance::inpainted, true) / 2);
  EXPECT_GT(count(provenance::inpainted, true), count(provenance::estimated, true) / 4);
}

// Where something else stands in front of its other end, in other colours.
TEST_F(Bars, AreNotPaintedInTheColorsOfWhatHidesThem) {
  look();
  Image<Bgr> picture;
  copy(seen->frame.color.view(), picture);
  result.reconstruction.region = seen->rig.color.bounds();
  result.reconstruction.depth_m = Image<float>(on_bar.width(), on_bar.height(), 0.F);
  for (int y = hidden.bottom(); y < on_bar.height(); ++y) {
    for (int x = 0; x < on_bar.width(); ++x) {
      if (on_bar(x, y) == 0) continue;
      picture(x, y) = {30, 220, 30};
      result.reconstruction.depth_m(x, y) = 0.6F;
    }
  }
  seen->frame.color = picture;
  paint();
  ASSERT_EQ(search.bars().size(), 1U);
  EXPECT_TRUE(search.bars()[0].goes_on);
  int painted = 0;
  for (int x = hidden.x; x < hidden.right(); ++x) {
    if (result.provenance(x, hidden.bottom() - 2) != provenance::estimated) continue;
    const Bgr& pixel = result.picture(x, hidden.bottom() - 2);
    EXPECT_LT(pixel.g, pixel.r + 40) << x;
    ++painted;
  }
  EXPECT_GT(painted, 4);
}

/// The wall on the right of a bar lies in its shadow.
void cast_shadow(const Mask& on_bar, Image<Bgr>& picture, int shadow_px) {
  for (int y = 0; y < picture.height(); ++y) {
    int x = 0;
    while (on_bar(x, y) == 0) ++x;
    while (on_bar(x, y) != 0) ++x;
    for (int i = 0; i < shadow_px; ++i) {
      Bgr& pixel = picture(x + i, y);
      pixel = {static_cast<std::uint8_t>(pixel.b / 2), static_cast<std::uint8_t>(pixel.g / 2),
               static_cast<std::uint8_t>(pixel.r / 2)};
    }
  }
}

TEST_F(Bars, ThrowTheirShadowsOnInventedWalls) {
  constexpr int shadow_px = 8;
  look();
  Image<Bgr> truth;
  copy(seen->frame.color.view(), truth);
  cast_shadow(on_bar, truth, shadow_px);
  seen->frame.color = truth;
  const auto darkest_beside = [&](int shift) {
    int least = 255;
    for (int y = hidden.y + 4; y < hidden.bottom() - 4; ++y) {
      int x = hidden.right() - 1;
      while (on_bar(x, y) == 0) --x;
      least = std::min<int>(least, result.picture(x + shift, y).g);
    }
    return least;
  };
  const int wall = darkest_beside(shadow_px / 2);
  const double before = testing::psnr_db(result.picture, truth, masks.color);
  paint();
  EXPECT_NEAR(darkest_beside(shadow_px / 2), wall / 2.0, 6);
  EXPECT_NEAR(darkest_beside(3 * shadow_px), wall, 6);
  EXPECT_GT(testing::psnr_db(result.picture, truth, masks.color), before + 8);
  EXPECT_GT(count(provenance::inpainted, false), 20 * count(provenance::estimated, false));
}

// Nor on what stands in front of the wall.
TEST_F(Bars, ThrowNoShadowsOnWhatIsSeen) {
  look();
  Image<Bgr> truth;
  copy(seen->frame.color.view(), truth);
  cast_shadow(on_bar, truth, 8);
  seen->frame.color = truth;
  for (int y = 0; y < on_bar.height(); ++y) {
    for (int x = 0; x < on_bar.width(); ++x) {
      if (on_bar(x, y) == 0 && y < 125) result.provenance(x, y) = provenance::camera;
      if (on_bar(x, y) == 0 && y >= 125) result.surfaces.label(x, y) = surface_label::foreground;
    }
  }
  Image<Bgr> before;
  copy(ImageView<Bgr>(result.picture), before);
  paint();
  EXPECT_EQ(search.bars().size(), 1U);
  for (int y = hidden.y; y < hidden.bottom(); ++y) {
    for (int x = hidden.x; x < hidden.right(); ++x) {
      if (result.provenance(x, y) != provenance::estimated) {
        ASSERT_NEAR(result.picture(x, y).g, before(x, y).g, 3 + 40 * on_bar(x, y))
            << x << ", " << y;
      }
    }
  }
}

// Each with a hole of its own.
TEST_F(Bars, ThatCrossDoNotExcludeEachOther) {
  look();
  const Bar bar = find().at(0);
  Bar crossing = bar;
  crossing.inward = bar.across();
  crossing.entry = bar.at(40, -30);
  EXPECT_FALSE(exclude_each_other(*views, bar, crossing));
  Bar beside = bar;
  beside.entry = bar.at(5, bar.width_px / 2);
  EXPECT_TRUE(exclude_each_other(*views, bar, beside));
  beside.entry = bar.at(5, 3 * bar.width_px);
  EXPECT_FALSE(exclude_each_other(*views, bar, beside));
}

TEST(BarsBeside, TheSpaceBetweenTwoIsNone) {
  const auto bar = [](float x, float width_px, float score) {
    Bar result;
    result.entry = {x, 100 + x / 10};
    result.inward = Eigen::Vector2f::UnitY();
    result.width_px = width_px;
    result.score = score;
    return result;
  };
  const Bar left = bar(100, 10, 8);
  const Bar space = bar(120, 31, 12);
  const Bar right = bar(141, 12, 6);
  EXPECT_TRUE(is_between(space, std::array{left, space, right}));
  EXPECT_FALSE(is_between(left, std::array{left, space, right}));
  EXPECT_FALSE(is_between(space, std::array{left, space}));
  EXPECT_FALSE(is_between(space, std::array{left, space, bar(151, 12, 6)}));  // 10 pixels apart
  EXPECT_FALSE(is_between(space, std::array{left, space, bar(141, 12, 3)}));  // hardly one
}

}  // namespace
}  // namespace diminish
