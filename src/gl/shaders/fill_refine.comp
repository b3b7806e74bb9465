// A grid's open cells from the coarser grid's, relaxed: a tile a work group, with as much around it
// as the half sweeps reach, so that nobody waits for another. FINEST: the picture's pixels, of
// all labels. Else one label's cells.

layout(local_size_x = 16, local_size_y = 16) in;

const int TILE = 32;
const int SIDE = TILE + 2 * HALF_SWEEPS;
// Where an open cell's labels begin.
const float FIRST_OPEN = 256.0;
// The colours, and: of an open cell FIRST_OPEN and its label, of a known one its label and 1; 0:
// there is none.
shared vec4 values[SIDE * SIDE];
shared bool has_open;

const ivec2 beside[4] = ivec2[](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

// Bilinear, of the cells that are there.
vec3 interpolated(ivec2 place, uint layer) {
  ivec2 near = place >> 1;
  ivec2 side = 2 * (place & 1) - 1;
  vec4 sum = vec4(0);
  for (int i = 0; i < 4; ++i) {
    uint cell = cell_at(coarse, coarse_at, layer, near + side * ivec2(i & 1, i >> 1));
    float weight = i == 0 ? 9.0 : i == 3 ? 1.0 : 3.0;
    if (cell >> 30 != 0u) sum += weight * vec4(color_of(cell), 1);
  }
  return sum.rgb / max(sum.w, 1.0);
}

bool is_black(ivec2 place) { return ((place.x + place.y) & 1) != 0; }

// Red cells are relaxed first, from black ones.
vec4 start_value(ivec2 place, uint layer) {
#ifdef FINEST
  if (!holds(fine, place)) return vec4(0);
  uint pixel = pixels[index_in(fine, place)];
  uint state = pixel >> 24;
  if ((state & OPEN) == 0u) return vec4(levels_of(pixel), state + 1u);
  layer = layer_of(state);
  return vec4(is_black(place) ? interpolated(place, layer) : vec3(0), FIRST_OPEN + float(layer));
#else
  uint cell = cell_at(fine, fine_at, layer, place);
  uint kind = cell >> 30;
  if (kind != IS_OPEN) return vec4(color_of(cell), kind == 0u ? 0u : layer + 1u);
  return vec4(is_black(place) ? interpolated(place, layer) : vec3(0), FIRST_OPEN + float(layer));
#endif
}

void relax(int at, ivec2 place, int half_sweep) {
  vec4 own = values[at];
  if (own.w < FIRST_OPEN) return;
  float layer = own.w - FIRST_OPEN;
  vec4 sum = vec4(0);
  for (int k = 0; k < 4; ++k) {
    vec4 other = values[at + beside[k].y * SIDE + beside[k].x];
    bool is_known = other.w > 0.0 && other.w < FIRST_OPEN;
    bool counts = other.w == own.w || is_known && (layer == 0.0 || other.w == layer + 1.0);
    if (counts) sum += vec4(other.rgb, 1);
  }
  vec3 mean = sum.rgb / max(sum.w, 1.0);
  if (sum.w == 0.0) {
    // All alone.
    if (half_sweep == 0) values[at].rgb = interpolated(place, uint(layer));
  } else {
    values[at].rgb = own.rgb + FACTORS[half_sweep] * (mean - own.rgb);
  }
}

void main() {
  uint layer = gl_WorkGroupID.z;
#ifndef FINEST
  if (!is_solved(layer)) return;
#endif
  ivec2 corner = fine.xy + TILE * ivec2(gl_WorkGroupID.xy) - HALF_SWEEPS;
  int own = int(gl_LocalInvocationIndex);
  if (own == 0) has_open = false;
  barrier();
  for (int i = own; i < TILE * TILE; i += 256) {
    ivec2 place = corner + HALF_SWEEPS + ivec2(i % TILE, i / TILE);
#ifdef FINEST
    if (holds(fine, place) && (pixels[index_in(fine, place)] >> 24 & OPEN) != 0u) has_open = true;
#else
    if (cell_at(fine, fine_at, layer, place) >> 30 == IS_OPEN) has_open = true;
#endif
  }
  barrier();
  if (!has_open) return;
  for (int i = own; i < SIDE * SIDE; i += 256) {
    values[i] = start_value(corner + ivec2(i % SIDE, i / SIDE), layer);
  }
  barrier();
  for (int k = 0; k < HALF_SWEEPS; ++k) {
    // What is left of the border after k half sweeps does not matter any more.
    int width = SIDE - 2 * (k + 1);
    int across = (width + 1) / 2;
    for (int i = own; i < across * width; i += 256) {
      int y = k + 1 + i / across;
      int x = k + 1 + 2 * (i % across);
      x += (corner.x + corner.y + x + y + k) & 1;
      if (x < SIDE - (k + 1)) relax(y * SIDE + x, corner + ivec2(x, y), k);
    }
    barrier();
  }
  for (int i = own; i < TILE * TILE; i += 256) {
    ivec2 at = HALF_SWEEPS + ivec2(i % TILE, i / TILE);
    ivec2 place = corner + at;
    vec4 value = values[at.y * SIDE + at.x];
    if (value.w < FIRST_OPEN) continue;
#ifdef FINEST
    uint index = picture_index(place);
    if (is_solved(uint(value.w - FIRST_OPEN))) {
      picture[index] = round_levels(value.rgb);
    } else if (is_rest != 0) {
      picture[index] = 0u;
      provenance[index] = UNKNOWN;
    }
#else
    cells[fine_at + int(layer) * fine.z * fine.w + index_in(fine, place)] =
        pack_cell(value.rgb, IS_OPEN);
#endif
  }
}
