// Rule 2: fills each cell of the current turn's camera. One invocation per cell.

layout(local_size_x = 64) in;

bool is_covered(uint turn, ivec2 first, ivec2 end) {
  for (int y = first.y; y < end.y; ++y) {
    for (int x = first.x; x < end.x; ++x) {
      if ((seen_by[y * region.z + x] >> turn & 1u) == 0u) return false;
    }
  }
  return true;
}

float z_at(ivec2 place) {
  return 1.0 / uintBitsToFloat(kept_inverse_z_at(layer, region.xy + place));
}
vec2 texture_at(ivec2 place) { return seen_place(region.xy + place, z_at(place)); }

void main() {
  ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  uint turn = 0u;
  while (turn < blended_cameras() && works[turn].turn != layer) ++turn;
  if (cell.x >= grid_size().x || turn == blended_cameras()) return;
  ivec2 first = CELL_PX * cell;
  // The last cells take the rest.
  ivec2 end = mix(first + CELL_PX, region.zw, equal(cell, grid_size() - 1));
  int own = cell_index(turn, cell);
  if (!is_covered(turn, first, end)) {
    cells[own].resolution = NOT_COVERED;
    cells[own].z_m = 0.0;
    return;
  }
  ivec2 last = end - 1;
  vec2 origin = texture_at(first);
  vec2 along_x = texture_at(ivec2(last.x, first.y)) - origin;
  vec2 along_y = texture_at(ivec2(first.x, last.y)) - origin;
  float area = along_x.x * along_y.y - along_x.y * along_y.x;
  ivec2 pixels = max(last - first, ivec2(1));
  cells[own].resolution =
      clamp(area / float(pixels.x * pixels.y), LEAST_RESOLUTION, MOST_RESOLUTION);
  cells[own].z_m = z_at(first);
}
