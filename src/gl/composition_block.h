#pragma once

#include <cstdint>

#include "gl/frame_block.h"
#include "scene/background_planes.h"
#include "scene/cast_shadows.h"
#include "scene/color_map.h"

namespace diminish::gl {

// What composition.glsl declares, member by member, by the rules of std140.

struct PlaneBlock {
  float normal[3], distance_m;

  PlaneBlock() = default;
  explicit PlaneBlock(const BackgroundPlane& plane)
      : normal{plane.normal.x(), plane.normal.y(), plane.normal.z()},
        distance_m(plane.distance_m) {}
};

struct ShadowBlock {
  PlaneBlock plane;
  float origin[3], label, along_u[4], along_v[4];

  ShadowBlock() = default;
  explicit ShadowBlock(const CastShadow& shadow)
      : plane(shadow.ground.plane),
        origin{shadow.ground.origin.x(), shadow.ground.origin.y(), shadow.ground.origin.z()},
        label(shadow.label),
        along_u{shadow.ground.along_u.x(), shadow.ground.along_u.y(), shadow.ground.along_u.z()},
        along_v{shadow.ground.along_v.x(), shadow.ground.along_v.y(), shadow.ground.along_v.z()} {}
};

struct ColorMapBlock {
  float rows[3][4], field[4], last_field, center_x, center_y, half_width;
  std::uint32_t source, padding[3];

  ColorMapBlock() = default;
  ColorMapBlock(const ColorMap& map, std::uint32_t source_)
      : field{map.field[0], map.field[1], map.field[2], map.field[3]},
        last_field(map.field[4]),
        center_x(map.center.x()),
        center_y(map.center.y()),
        half_width(map.half_width),
        source(source_),
        padding{} {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) rows[i][j] = map.matrix(i, j);
      rows[i][3] = map.offset[i];
    }
  }
};

struct CompositionBlock {
  PlaneBlock planes[BackgroundPlanes::most_planes];
  ShadowBlock shadows[BackgroundPlanes::most_planes];
  std::uint32_t plane_count, shadow_count, camera_at, light_at;
  std::int32_t node_columns, node_rows, ray_columns;
  std::uint32_t missing_code, rim_px;
  float opacity;
  std::uint32_t mixes_second, padding;
  ColorMapBlock maps[most_cameras];
};
static_assert(sizeof(ShadowBlock) == 64 && sizeof(ColorMapBlock) == 96);
// The size that every driver supports for a uniform block.
static_assert(sizeof(CompositionBlock) <= 16384);

}  // namespace diminish::gl
