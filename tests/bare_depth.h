#pragma once

#include "analytic_scene.h"

namespace diminish::testing {

/// What is in a part of the user's picture is to be removed.
inline void hide(const Rect& hidden, OcclusionMasks& masks) {
  for (int y = hidden.y; y < hidden.bottom(); ++y) {
    for (int x = hidden.x; x < hidden.right(); ++x) masks.color(x, y) = 255;
  }
}

/// The first RGB-D camera's depth image of a scene, without what is `bare(hit)`.
template <class Bare>
Image<std::uint16_t> depth_image_without(const AnalyticScene& scene, const AnalyticFrame& seen,
                                         const Bare& bare) {
  const RgbdCamera& camera = seen.rig.rgbd[0];
  const Lens lens(camera.depth);
  const RigidTransform& depth_from_world = *seen.poses.depth_from_world[0];
  Image<std::uint16_t> depth = scene.depth_image(lens, depth_from_world, camera.depth_unit_m);
  scene.render(lens, depth_from_world, [&](int x, int y, const AnalyticScene::Hit& hit) {
    if (bare(hit)) depth(x, y) = 0;
  });
  return depth;
}

}  // namespace diminish::testing
