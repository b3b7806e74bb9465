// Makes the second grid from the pixels: which pixels are open in the end, and which lend their
// colour to which labels. One invocation per cell of the grid in `coarse`.

layout(local_size_x = 8, local_size_y = 8) in;

const int SIDE = 2 * 8 + 2;
shared uint states[SIDE * SIDE];
shared uint known_here, open_here;

const ivec2 beside[4] = ivec2[](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

// A hole that mostly borders on something in front of its plane is not filled from the plane. The
// answer is the same before and after it has been given up.
uint final_state(ivec2 place) {
  uint state = state_at(place);
  if ((state & OPEN) == 0u || state == OUTSIDE || state == REST) return state;
  if (state != OPEN) {
    Part part = parts[parts[index_in(window, place)].parent];
    if (100u * part.on_plane < RIM_PERCENT * (part.on_plane + part.in_front)) state = OPEN;
  }
  if (is_rest == 0) return state;
  uint label = state & LABEL;
  return (known_labels >> label & 1u) != 0u ? label : REST;
}

// PlaneColors::around.
bool color_around(ivec2 place, uint label, out vec3 mean) {
  ivec2 grid = (region.zw + CELL - 1) / CELL;
  ivec2 cell = (place - region.xy) / CELL;
  ivec2 first = max(cell - REACH, ivec2(0));
  ivec2 last = min(cell + REACH, grid - 1);
  uvec4 sum = uvec4(0);
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      uvec2 part = plane_sums[(y * grid.x + x) * PLANES + int(label - FIRST_PLANE)];
      sum += uvec4(part.x & 0xFFFFu, part.x >> 16, part.y & 0xFFFFu, part.y >> 16);
    }
  }
  mean = vec3(sum.xyz) / float(max(sum.w, 1u));
  return sum.w >= FEWEST;
}

vec3 lent_color(ivec2 place, uint label) {
  uint index = picture_index(place);
  vec3 own = levels_of(picture[index]);
  bool is_plane = label >= FIRST_PLANE && label < LABELS;
  vec3 around;
  if ((provenance[index] & 0xFFu) != 0u || !is_plane || !holds(region, place)) return own;
  if (!color_around(place, label, around)) return own;
  return dot(own, vec3(1)) < SHADOW * dot(around, vec3(1)) ? around : own;
}

void main() {
  ivec2 corner = 2 * (coarse.xy + 8 * ivec2(gl_WorkGroupID.xy)) - 1;
  for (int i = int(gl_LocalInvocationIndex); i < SIDE * SIDE; i += 64) {
    states[i] = final_state(corner + ivec2(i % SIDE, i / SIDE));
  }
  if (gl_LocalInvocationIndex == 0u) known_here = open_here = 0u;
  barrier();

  ivec2 cell = coarse.xy + ivec2(gl_GlobalInvocationID.xy);
  uint lent_to[4];
  uint open_of[4];
  vec3 colors[4];
  for (int i = 0; i < 4; ++i) {
    ivec2 place = 2 * cell + ivec2(i & 1, i >> 1);
    ivec2 at = place - corner;
    uint state = states[at.y * SIDE + at.x];
    lent_to[i] = 0u;
    open_of[i] = 0u;
    colors[i] = vec3(0);
    if (state == OUTSIDE || !holds(window, place)) continue;
    if ((state & OPEN) != 0u) {
      open_of[i] = 1u << layer_of(state);
    } else {
      for (int k = 0; k < 4; ++k) {
        ivec2 other_at = at + beside[k];
        uint other = states[other_at.y * SIDE + other_at.x];
        if ((other & OPEN) == 0u || other == OUTSIDE) continue;
        uint layer = layer_of(other);
        if (layer == 0u || layer == state) lent_to[i] |= 1u << layer;
      }
      if (lent_to[i] != 0u) colors[i] = lent_color(place, state);
    }
    pixels[index_in(window, place)] = round_levels(colors[i]) | state << 24;
  }
  uint any_lent = lent_to[0] | lent_to[1] | lent_to[2] | lent_to[3];
  uint any_open = open_of[0] | open_of[1] | open_of[2] | open_of[3];
  if (any_lent != 0u) atomicOr(known_here, any_lent);
  if (any_open != 0u) atomicOr(open_here, any_open);
  if (holds(coarse, cell)) {
    uint layers = is_rest != 0 ? 1u : LABELS;
    for (uint layer = 0u; layer < layers; ++layer) {
      vec4 sum = vec4(0);
      for (int i = 0; i < 4; ++i) sum += float(lent_to[i] >> layer & 1u) * vec4(colors[i], 1);
      uint kind = sum.w > 0.0 ? IS_KNOWN : (any_open >> layer & 1u) * IS_OPEN;
      cells[coarse_at + int(layer) * coarse.z * coarse.w + index_in(coarse, cell)] =
          pack_cell(sum.xyz / max(sum.w, 1.0), kind);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  if (is_rest != 0) {
    if (known_here != 0u) atomicOr(rest_is_known, known_here);
  } else {
    if (known_here != 0u) atomicOr(known_labels, known_here);
    if (open_here != 0u) atomicOr(open_labels, open_here);
  }
}
