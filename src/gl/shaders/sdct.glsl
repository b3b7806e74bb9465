// The rules of step-discontinuity constrained triangulation, as in src/render/sdct.h.

const int subpixels = 1 << SUBPIXEL_BITS;

// A vertex's place in the picture (x, y: in 1/256 pixels), its 1 / z in the colour camera's frame (z;
// 0: not a vertex) and its z in the depth sensor's frame (w). The latter two are floats' bits.
float inverse_z_of(ivec4 position) { return intBitsToFloat(position.z); }
bool is_vertex(ivec4 position) { return position.z != 0; }

// p.x * q.y - p.y * q.x, of which the sign is exact and the value correctly rounded.
float cross_product(ivec2 p, ivec2 q) {
  const int limit = 1 << 14;
  if (all(lessThan(max(abs(p), abs(q)), ivec2(limit)))) return float(p.x * q.y - p.y * q.x);
  return float(double(p.x) * double(q.y) - double(p.y) * double(q.x));
}

// Positive on the triangle's side of the edge from a to b.
float edge_value(ivec2 a, ivec2 b, ivec2 point) { return cross_product(b - a, point - a); }

// Rule 4.
bool top_or_left(ivec2 a, ivec2 b) { return b.y < a.y || (b.y == a.y && b.x > a.x); }

// Rule 3, except for facing.
bool joined(vec3 depths_m) {
  float least = min(min(depths_m.x, depths_m.y), depths_m.z);
  float most = max(max(depths_m.x, depths_m.y), depths_m.z);
  precise float relative = least * inverse_reach;
  precise float limit = max(1.0, relative * relative) * threshold_m;
  return most - least < limit;
}

// The pixels inside the region whose centres a triangle may cover: first column and row, and last.
ivec4 pixels_of_bounding_box(ivec2 a, ivec2 b, ivec2 c) {
  ivec2 first = (min(min(a, b), c) + (subpixels - 1)) >> SUBPIXEL_BITS;
  ivec2 last = max(max(a, b), c) >> SUBPIXEL_BITS;
  return ivec4(max(first, region.xy), min(last, region.xy + region.zw - 1));
}
