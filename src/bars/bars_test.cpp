#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "analytic_scene.h"
#include "bare_depth.h"
#include "bars/bar_painting.h"
#include "bars/bar_search.h"
#include "inpaint/rim_lines.h"
#include "picture_difference.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

/// A bar across the whole picture in front of an even wall; no depth is measured on it.
class Bars : public ::testing::Test {
 protected:
  Bars() {
    scene.box_min = {-0.02, -2, 0.06};
    scene.box_max = {0.02, 2, 0.08};
    scene.wave_m = 20;
  }

  void look(bool has_depth = false) {
    seen.emplace(scene, std::vector<Eigen::Vector3d>{{-0.5, 0.05, 1.05}});
    masks = testing::empty_masks(seen->rig);
    testing::hide(hidden, masks);
    seen->frame.rgbd[0].depth = testing::depth_image_without(
        scene, *seen, [&](const AnalyticScene::Hit& hit) { return hit.on_box && !has_depth; });
    const RigidTransform& color_from_world = *seen->poses.color_from_world;
    const Eigen::Vector3d normal = color_from_world.rotation * Eigen::Vector3d::UnitZ();
    planes = {{normal.cast<float>(), static_cast<float>(normal.dot(color_from_world.translation))}};

    on_bar.resize(seen->rig.color.width, seen->rig.color.height);
    scene.render(Lens(seen->rig.color), color_from_world,
                 [&](int x, int y, const AnalyticScene::Hit& hit) { on_bar(x, y) = hit.on_box; });
    AnalyticScene without = scene;
    without.has_box = false;
    const Image<Bgr> wall = without.color_image(Lens(seen->rig.color), color_from_world);
    copy(seen->frame.color.view(), result.picture);
    result.provenance = Image<std::uint8_t>(on_bar.width(), on_bar.height(), provenance::camera);
    for (int y = hidden.y; y < hidden.bottom(); ++y) {
      for (int x = hidden.x; x < hidden.right(); ++x) {
        result.picture(x, y) = wall(x, y);
        result.provenance(x, y) = provenance::inpainted;
      }
    }
    result.report.mask_pixels = result.report.missing_pixels =
        static_cast<std::size_t>(hidden.width) * static_cast<std::size_t>(hidden.height);
    result.report.valid_pixels = 0;
    result.surfaces.region = seen->rig.color.bounds();
    result.surfaces.label =
        Image<std::uint8_t>(on_bar.width(), on_bar.height(), surface_label::first_plane);
    result.reconstruction.region = Rect();
  }

  const std::vector<Bar>& find() {
    lines.find(seen->frame.color, masks.color, hidden);
    views.emplace(seen->rig);
    views->begin(seen->frame, seen->poses, masks);
    search.find({lines.lines(), *views, planes, result.surfaces, masks.color});
    return search.bars();
  }
  void paint() {
    const BarPainting::Input input{find(), *views, planes, seen->frame.color, masks.color, hidden};
    painting.lay_out(input);
    painting.paint(input, result);
  }
  std::size_t count(std::uint8_t origin, bool of_bar) const {
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < on_bar.size(); ++i) {
      pixels += result.provenance.data()[i] == origin && (on_bar.data()[i] != 0) == of_bar ? 1 : 0;
    }
    return pixels;
  }

  AnalyticScene scene;
  const Rect hidden{100, 80, 120, 90};  ///< by the object, in the user's picture
  std::optional<AnalyticFrame> seen;
  OcclusionMasks masks;
  std::vector<BackgroundPlane> planes;
  Mask on_bar;  ///< what the user would see of it
  DiminishedFrame result;
  RimLines lines;
  std::optional<BarViews> views;
  BarSearch search;
  BarPainting painting;
};

// Against the ray caster.
TEST_F(Bars, APipeIsFoundWhereItIs) {
  look();
  const auto& bars = find();
  ASSERT_EQ(bars.size(), 1U);
  const Bar& bar = bars[0];
  EXPECT_NEAR(planes[0].distance_m + 0.08, bar.plane.distance_m, 0.015);
  EXPECT_TRUE(bar.goes_on);
  for (const float along : {0.F, 45.F, 90.F}) {
    const Eigen::Vector2f at = bar.at(along, 0);
    const auto y = static_cast<int>(std::lrint(at.y()));
    int first = 0;
    while (on_bar(first, y) == 0) ++first;
    int last = first;
    while (on_bar(last + 1, y) != 0) ++last;
    EXPECT_NEAR(at.x(), (first + last) / 2.0, 2) << "at row " << y;
    EXPECT_NEAR(bar.width_px, last - first + 1, 2);
  }
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

}  // namespace
}  // namespace diminish
