// Makes all grids from `coarse` on out of `fine` and solves them: one label per work group, in its
// own memory.

layout(local_size_x = 256) in;

const int GRIDS = 16;
// The colours and the kind.
shared vec4 values[COARSEST_CELLS];

const ivec2 beside[4] = ivec2[](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

vec4 value_at(ivec4 grid, int begin, ivec2 place) {
  return holds(grid, place) ? values[begin + index_in(grid, place)] : vec4(0);
}

vec4 merged(vec4 a, vec4 b, vec4 c, vec4 d) {
  vec4 known = vec4(equal(vec4(a.w, b.w, c.w, d.w), vec4(IS_KNOWN)));
  float count = dot(known, vec4(1));
  vec3 sum = known.x * a.rgb + known.y * b.rgb + known.z * c.rgb + known.w * d.rgb;
  return vec4(sum / max(count, 1.0), max(max(a.w, b.w), max(c.w, d.w)));
}

vec4 unpack(uint cell) { return vec4(color_of(cell), float(cell >> 30)); }

void main() {
  uint layer = gl_WorkGroupID.z;
  if (is_rest == 0 && layer == 0u && gl_LocalInvocationIndex == 0u) {
    bool is_needed = (open_labels & ~known_labels) != 0u;
    for (int i = 0; i < REST_PASSES; ++i) {
      rest_groups[3 * i] = uint(rest_sizes[i].x);
      rest_groups[3 * i + 1] = uint(rest_sizes[i].y);
      rest_groups[3 * i + 2] = is_needed ? 1u : 0u;
    }
  }
  if (!is_solved(layer)) return;

  ivec4 grids[GRIDS];
  int begins[GRIDS + 1];
  grids[0] = coarse;
  begins[0] = 0;
  int count = 1;
  for (;;) {
    ivec4 last = grids[count - 1];
    begins[count] = begins[count - 1] + last.z * last.w;
    if (last.z * last.w == 1) break;
    grids[count++] = coarser(last);
  }
  int own = int(gl_LocalInvocationIndex);
  for (int i = own; i < begins[1]; i += 256) {
    ivec2 at = 2 * (coarse.xy + ivec2(i % coarse.z, i / coarse.z));
    values[i] = merged(unpack(cell_at(fine, fine_at, layer, at)),
                       unpack(cell_at(fine, fine_at, layer, at + ivec2(1, 0))),
                       unpack(cell_at(fine, fine_at, layer, at + ivec2(0, 1))),
                       unpack(cell_at(fine, fine_at, layer, at + ivec2(1, 1))));
  }
  barrier();
  for (int l = 1; l < count; ++l) {
    ivec4 upper = grids[l - 1];
    ivec4 grid = grids[l];
    for (int i = own; i < grid.z * grid.w; i += 256) {
      ivec2 at = 2 * (grid.xy + ivec2(i % grid.z, i / grid.z));
      values[begins[l] + i] = merged(value_at(upper, begins[l - 1], at),
                                     value_at(upper, begins[l - 1], at + ivec2(1, 0)),
                                     value_at(upper, begins[l - 1], at + ivec2(0, 1)),
                                     value_at(upper, begins[l - 1], at + ivec2(1, 1)));
    }
    barrier();
  }
  for (int l = count - 2; l >= 0; --l) {
    ivec4 grid = grids[l];
    ivec4 lower = grids[l + 1];
    int cell_count = grid.z * grid.w;
    for (int i = own; i < cell_count; i += 256) {
      if (values[begins[l] + i].w != IS_OPEN) continue;
      ivec2 place = grid.xy + ivec2(i % grid.z, i / grid.z);
      ivec2 near = place >> 1;
      ivec2 side = 2 * (place & 1) - 1;
      vec4 a = value_at(lower, begins[l + 1], near);
      vec4 b = value_at(lower, begins[l + 1], near + ivec2(side.x, 0));
      vec4 c = value_at(lower, begins[l + 1], near + ivec2(0, side.y));
      vec4 d = value_at(lower, begins[l + 1], near + side);
      vec4 weights = vec4(9, 3, 3, 1) * vec4(greaterThan(vec4(a.w, b.w, c.w, d.w), vec4(0)));
      vec3 sum = weights.x * a.rgb + weights.y * b.rgb + weights.z * c.rgb + weights.w * d.rgb;
      values[begins[l] + i].rgb = sum / dot(weights, vec4(1));
    }
    barrier();
    for (int k = 0; k < COARSE_HALF_SWEEPS; ++k) {
      for (int i = own; i < cell_count; i += 256) {
        ivec2 place = grid.xy + ivec2(i % grid.z, i / grid.z);
        if (((place.x + place.y + k) & 1) != 0) continue;
        vec4 cell = values[begins[l] + i];
        if (cell.w != IS_OPEN) continue;
        vec4 sum = vec4(0);
        for (int n = 0; n < 4; ++n) {
          vec4 other = value_at(grid, begins[l], place + beside[n]);
          sum += other.w > 0.0 ? vec4(other.rgb, 1) : vec4(0);
        }
        if (sum.w == 0.0) continue;
        values[begins[l] + i].rgb += COARSE_FACTORS[k] * (sum.rgb / sum.w - cell.rgb);
      }
      barrier();
    }
  }
  int first = coarse_at + int(layer) * begins[1];
  for (int i = own; i < begins[1]; i += 256) {
    cells[first + i] = pack_cell(values[i].rgb, uint(values[i].w));
  }
}
