// Computes a grid's open cells from the coarser grid and relaxes them: one tile per work group,
// with a border as wide as the half sweeps reach, so that no group waits for another. FINEST: the
// picture's pixels, of all labels. Otherwise one label's cells.

// A row of a tile and its border, red or black cells only; and eight rows.
layout(local_size_x = 24, local_size_y = 8) in;

const int TILE = 32;
const int SIDE = TILE + 2 * HALF_SWEEPS;
// Where an open cell's labels begin.
const uint FIRST_OPEN = 256u;
// Colours in 64ths of a level, starting at -256 levels: blue and green; red and, in the higher
// half, FIRST_OPEN plus the label of an open cell, or the label of a known one plus 1; 0: no cell.
shared uint blue_green[SIDE * SIDE];
shared uint red_state[SIDE * SIDE];
shared bool has_open;

const ivec2 beside[4] = ivec2[](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

vec3 value_at(int at, uint red_and_state) {
  uint others = blue_green[at];
  return vec3(others & 0xFFFFu, others >> 16, red_and_state & 0xFFFFu) / 64.0 - 256.0;
}

void set_value(int at, vec3 value, uint state) {
  uvec3 bits = uvec3(clamp(64.0 * (value + 256.0) + 0.5, 0.0, 65535.0));
  blue_green[at] = bits.x | bits.y << 16;
  red_state[at] = bits.z | state << 16;
}

// Bilinear, from the cells that exist.
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
void start(int at, ivec2 place, uint layer) {
#ifdef FINEST
  uint pixel = holds(window, place) ? pixels[index_in(window, place)] : OUTSIDE << 24;
  uint state = pixel >> 24;
  bool is_open = (state & OPEN) != 0u && state != OUTSIDE;
  vec3 color = levels_of(pixel);
  layer = layer_of(state);
  uint known_state = state == OUTSIDE ? 0u : state + 1u;
#else
  uint cell = cell_at(fine, fine_at, layer, place);
  bool is_open = cell >> 30 == IS_OPEN;
  vec3 color = color_of(cell);
  uint known_state = cell >> 30 == 0u ? 0u : layer + 1u;
#endif
  if (is_open && is_black(place)) color = interpolated(place, layer);
  set_value(at, color, is_open ? FIRST_OPEN + layer : known_state);
}

bool is_open_at(ivec2 place, uint layer) {
#ifdef FINEST
  uint state = state_at(place);
  return (state & OPEN) != 0u && state != OUTSIDE;
#else
  return cell_at(fine, fine_at, layer, place) >> 30 == IS_OPEN;
#endif
}

void relax(int at, ivec2 place, int half_sweep) {
  uint own = red_state[at];
  uint state = own >> 16;
  if (state < FIRST_OPEN) return;
  vec4 sum = vec4(0);
  for (int k = 0; k < 4; ++k) {
    int other_at = at + beside[k].y * SIDE + beside[k].x;
    uint other = red_state[other_at];
    uint other_state = other >> 16;
    bool is_known = other_state - 1u < FIRST_OPEN - 1u;
    bool counts = other_state == state || other_state == state - FIRST_OPEN + 1u ||
                  is_known && state == FIRST_OPEN;
    if (counts) sum += vec4(value_at(other_at, other), 1);
  }
  if (sum.w > 0.0) {
    vec3 before = value_at(at, own);
    set_value(at, before + FACTORS[half_sweep] * (sum.rgb / sum.w - before), state);
  } else if (half_sweep == 0) {
    // No neighbours.
    set_value(at, interpolated(place, state - FIRST_OPEN), state);
  }
}

void store(int at, ivec2 place, uint layer) {
  uint own = red_state[at];
  if (own >> 16 < FIRST_OPEN) return;
  vec3 color = value_at(at, own);
#ifdef FINEST
  uint index = picture_index(place);
  if (is_solved((own >> 16) - FIRST_OPEN)) {
    picture[index] = round_levels(color);
  } else if (is_rest != 0) {
    picture[index] = 0u;
    provenance[index] = UNKNOWN;
  }
#else
  cells[fine_at + int(layer) * fine.z * fine.w + index_in(fine, place)] = pack_cell(color, IS_OPEN);
#endif
}

void main() {
  uint layer = gl_WorkGroupID.z;
#ifndef FINEST
  if (!is_solved(layer)) return;
#endif
  ivec2 corner = fine.xy + TILE * ivec2(gl_WorkGroupID.xy) - HALF_SWEEPS;
  ivec2 own = ivec2(gl_LocalInvocationID.xy);
  if (own == ivec2(0)) has_open = false;
  barrier();
  for (int y = own.y; y < TILE; y += 8) {
    for (int x = own.x; x < TILE; x += 24) {
      if (is_open_at(corner + HALF_SWEEPS + ivec2(x, y), layer)) has_open = true;
    }
  }
  barrier();
  if (!has_open) return;
  for (int y = own.y; y < SIDE; y += 8) {
    for (int x = own.x; x < SIDE; x += 24) start(y * SIDE + x, corner + ivec2(x, y), layer);
  }
  barrier();
  for (int k = 0; k < HALF_SWEEPS; ++k) {
    // After k half sweeps the rest of the border no longer matters.
    for (int y = k + 1 + own.y; y < SIDE - (k + 1); y += 8) {
      int x = k + 1 + 2 * own.x;
      x += (corner.x + corner.y + x + y + k) & 1;
      if (x < SIDE - (k + 1)) relax(y * SIDE + x, corner + ivec2(x, y), k);
    }
    barrier();
  }
  for (int y = HALF_SWEEPS + own.y; y < HALF_SWEEPS + TILE; y += 8) {
    for (int x = HALF_SWEEPS + own.x; x < HALF_SWEEPS + TILE; x += 24) {
      store(y * SIDE + x, corner + ivec2(x, y), layer);
    }
  }
}
