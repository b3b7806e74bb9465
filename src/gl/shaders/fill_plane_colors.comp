// Computes the planes' colours in cells of the region that are not near an object:
// PlaneColors::collect.

layout(local_size_x = 16, local_size_y = 16) in;

const int SIDE = 16 + 2 * GAP;
shared bool has_object[SIDE * SIDE];

bool shows_object(ivec2 cell) {
  bool does = false;
  for (int y = 0; y < CELL; y += STEP) {
    for (int x = 0; x < CELL; x += STEP) {
      ivec2 place = region.xy + CELL * cell + ivec2(x, y);
      if (!holds(region, place)) continue;
      does = does || (provenance[picture_index(place)] & 0xFFu) != 0u;
    }
  }
  return does;
}

void main() {
  ivec2 grid = (region.zw + CELL - 1) / CELL;
  ivec2 corner = ivec2(gl_WorkGroupID.xy) * 16 - GAP;
  for (int i = int(gl_LocalInvocationIndex); i < SIDE * SIDE; i += 256) {
    has_object[i] = shows_object(corner + ivec2(i % SIDE, i / SIDE));
  }
  barrier();
  ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(cell, grid))) return;
  bool is_near = false;
  for (int y = 0; y <= 2 * GAP; ++y) {
    for (int x = 0; x <= 2 * GAP; ++x) {
      ivec2 at = ivec2(gl_LocalInvocationID.xy) + ivec2(x, y);
      is_near = is_near || has_object[at.y * SIDE + at.x];
    }
  }
  uvec2 sums[PLANES];
  for (int k = 0; k < PLANES; ++k) sums[k] = uvec2(0);
  for (int y = 0; y < CELL && !is_near; y += STEP) {
    for (int x = 0; x < CELL; x += STEP) {
      ivec2 place = region.xy + CELL * cell + ivec2(x, y);
      if (!holds(region, place)) continue;
      uint plane = (surface[index_in(region, place)] & 0xFFu) - FIRST_PLANE;
      if (plane >= PLANES) continue;
      uint color = picture[picture_index(place)];
      sums[plane] += uvec2(color & 255u | (color >> 8 & 255u) << 16, color >> 16 & 255u | 1u << 16);
    }
  }
  int first = (cell.y * grid.x + cell.x) * PLANES;
  for (int k = 0; k < PLANES; ++k) plane_sums[first + k] = sums[k];
}
