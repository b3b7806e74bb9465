#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "geometry/projection.h"

namespace diminish::gl {

// What frame.glsl declares, member by member, by the rules of std140.

struct LensBlock {
  float fx, fy, cx, cy;
  float distortion[8];
  float max_radius_squared;
  std::uint32_t model, padding[2];

  LensBlock() = default;
  explicit LensBlock(const Projection& p)
      : fx(p.fx),
        fy(p.fy),
        cx(p.cx),
        cy(p.cy),
        max_radius_squared(p.max_radius_squared),
        model(static_cast<std::uint32_t>(p.model)),
        padding{} {
    std::copy(p.distortion.begin(), p.distortion.end(), distortion);
  }
};

struct TransformBlock {
  float rows[3][4];

  TransformBlock() = default;
  explicit TransformBlock(const FloatTransform& transform) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) rows[i][j] = transform.r[i][j];
      rows[i][3] = transform.t[i];
    }
  }
};

struct FrameBlock {
  LensBlock color;
  std::int32_t region_x, region_y, region_width, region_height;
  float threshold_m, inverse_reach, agreement_m;
  std::uint32_t camera_count;
  std::int32_t tiles_x, tiles_y, tiles_width;
  std::uint32_t tiles_at;
  std::uint32_t most_blended, padding[3];
};
static_assert(sizeof(FrameBlock) == 128);

struct CameraBlock {
  LensBlock rgbd_color;
  TransformBlock rgbd_color_from_depth, color_from_depth;
  std::int32_t depth_width, depth_height, color_width, color_height;
  std::uint32_t depth_at, depth_mask_at, color_mask_at, color_at;
  float unit_m;
  std::uint32_t first_pixel;
  std::uint32_t source;
  std::uint32_t layer;
};
static_assert(sizeof(CameraBlock) == 208);

/// A camera's place in the colour camera's frame (blending.glsl): CameraPlace.
struct CameraPlaceBlock {
  float eye_m[4] = {};
  float forward[4] = {};

  explicit CameraPlaceBlock(const TransformBlock& color_from_depth) {
    for (int i = 0; i < 3; ++i) {
      eye_m[i] = color_from_depth.rows[i][3];
      forward[i] = color_from_depth.rows[i][2];
    }
  }
};

/// Ranges of buffers that shaders see as blocks begin at multiples of this, which every driver
/// accepts.
constexpr std::size_t block_alignment = 256;

/// The most RGB-D cameras of a frame.
constexpr std::size_t most_cameras = 128;

/// Work in work.glsl.
struct WorkBlock {
  std::uint32_t small_groups[3], small_count;
  std::uint32_t large_groups[3], large_count;
  std::uint32_t drawn_pixels, turn, blended, padding[53];
};
static_assert(sizeof(WorkBlock) == block_alignment);

}  // namespace diminish::gl
