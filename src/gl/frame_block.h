#pragma once

#include <cstdint>

#include "geometry/projection.h"

namespace diminish::gl {

// What frame.glsl declares, member by member.

struct LensBlock {
  float fx, fy, cx, cy, k1, k2, p1, p2, k3, max_radius_squared;

  LensBlock() = default;
  explicit LensBlock(const Projection& p)
      : fx(p.fx),
        fy(p.fy),
        cx(p.cx),
        cy(p.cy),
        k1(p.k1),
        k2(p.k2),
        p1(p.p1),
        p2(p.p2),
        k3(p.k3),
        max_radius_squared(p.max_radius_squared) {}
};

struct CameraBlock {
  LensBlock rgbd_color;
  FloatTransform rgbd_color_from_depth{RigidTransform()};
  FloatTransform color_from_depth{RigidTransform()};
  float unit_m;
  std::int32_t depth_width, depth_height, color_width, color_height;
  std::uint32_t first_pixel;
  std::uint32_t depth_at, depth_mask_at, color_mask_at, color_at;
  std::uint32_t source;
};
static_assert(sizeof(CameraBlock) == 45 * 4);

struct FrameBlock {
  LensBlock color;
  std::int32_t region_x, region_y, region_width, region_height;
  float threshold_m, inverse_reach, agreement_m;
  std::uint32_t camera_count;
};
static_assert(sizeof(FrameBlock) == 18 * 4);

}  // namespace diminish::gl
