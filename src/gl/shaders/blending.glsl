// Blends several cameras by the rules of layers.h: src/gl/camera_blending.h.

// CameraPlace (camera_place.h).
struct CameraPlace {
  vec4 eye_m, forward;
};

layout(std140, binding = 2) uniform Places {
  CameraPlace camera_places[MOST_CAMERAS];  // by place among the cameras that take part
};

layout(std430, binding = 1) readonly buffer AllWork { Work works[]; };
// The cameras that see the nearest surface of each pixel of the region: bit i is the i-th turn's.
layout(std430, binding = 2) buffer SeenBy { uint seen_by[]; };
// The ConfidenceGrid of each turn's camera.
struct Cell {
  float resolution, z_m;
  float trust;       // the confidence before it is smoothed
  float confidence;
};
layout(std430, binding = 3) buffer Cells { Cell cells[]; };

uint blended_cameras() { return works[0].blended; }

ivec2 grid_size() { return max(region.zw / CELL_PX, ivec2(1)); }

// Beyond the border the last cell is repeated.
int cell_index(uint turn, ivec2 cell) {
  ivec2 size = grid_size();
  ivec2 inside = clamp(cell, ivec2(0), size - 1);
  return (int(turn) * size.y + inside.y) * size.x + inside.x;
}

// The ray of a pixel with z = 1, without the lens' distortion.
vec3 pinhole_ray(vec2 pixel) {
  return vec3((pixel - color_lens.pinhole.zw) / color_lens.pinhole.xy, 1);
}
