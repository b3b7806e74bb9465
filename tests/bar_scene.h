#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "analytic_scene.h"
#include "bare_depth.h"
#include "bars/bar_painting.h"
#include "bars/bar_search.h"
#include "inpaint/rim_lines.h"

namespace diminish::testing {

/// A bar across the whole picture in front of an even wall; no depth is measured on it.
class BarScene : public ::testing::Test {
 protected:
  BarScene() {
    scene.box_min = {-0.02, -2, 0.06};
    scene.box_max = {0.02, 2, 0.08};
    scene.wave_m = 20;
  }

  void look(bool has_depth = false) {
    seen.emplace(scene, std::vector<Eigen::Vector3d>{{-0.5, 0.05, 1.05}}, LensModel::plumb_bob,
                 color_eye);
    masks = empty_masks(seen->rig);
    hide(hidden, masks);
    seen->frame.rgbd[0].depth = depth_image_without(
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
    look_for_lines();
    search.find({lines.lines(), *views, planes, result.surfaces, masks.color, {}});
    return search.bars();
  }
  void look_for_lines() {
    lines.find(seen->frame.color, masks.color, hidden);
    views.emplace(seen->rig);
    views->begin(seen->frame, seen->poses, masks);
  }
  void paint() {
    const BarPainting::Input input{find(),
                                   *views,
                                   planes,
                                   seen->frame.color,
                                   masks.color,
                                   result.surfaces,
                                   result.reconstruction,
                                   hidden};
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

  /// Against the ray caster.
  void expect_where_it_is(const Bar& bar) const {
    EXPECT_NEAR(planes[0].distance_m + 0.08, bar.plane.distance_m, 0.015);
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

  AnalyticScene scene;
  Eigen::Vector3d color_eye{0.05, 0.02, 1.2};
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

}  // namespace diminish::testing
