// Rules 4 and 5 of sdct.h: draws small cells, one per invocation. Its two triangles share no pixel
// and are drawn together. FIND_NEAREST: writes the nearest 1 / z of each pixel. Otherwise: writes
// the first of the nearest triangles.

layout(local_size_x = 64) in;

// A triangle's edge functions, the value of the edge opposite to each corner: small enough for 32
// bits.
struct Edges {
  ivec3 value;            // at the first pixel
  ivec3 step_x, step_y;  // from a pixel to the next
  ivec3 least;            // inside; edges that are neither top nor left do not own what is on them
  float scale;
};

Edges edges_of(ivec2 a, ivec2 b, ivec2 c, ivec2 first) {
  Edges edges;
  edges.step_x = ivec3(b.y - c.y, c.y - a.y, a.y - b.y);
  edges.step_y = ivec3(c.x - b.x, a.x - c.x, b.x - a.x);
  edges.value = edges.step_x * (first.x - ivec3(b.x, c.x, a.x)) +
                edges.step_y * (first.y - ivec3(b.y, c.y, a.y));
  edges.least = ivec3(top_or_left(b, c) ? 0 : 1, top_or_left(c, a) ? 0 : 1,
                      top_or_left(a, b) ? 0 : 1);
  edges.step_x *= subpixels;
  edges.step_y *= subpixels;
  ivec2 p = b - a;
  ivec2 q = c - a;
  edges.scale = 1.0 / float(p.x * q.y - p.y * q.x);
  return edges;
}

void draw(uint entry) {
  uint cell = entry >> 2;
  uint first = first_pixel + cell;
  uint below = first + uint(depth_size.x);
  ivec4 a = position_of(first);
  ivec4 b = position_of(first + 1u);
  ivec4 c = position_of(below);
  ivec4 e = position_of(below + 1u);
  // The corner that a single triangle lacks is moved onto one that it has.
  bool has_first = (entry & 1u) != 0u;
  bool has_second = (entry & 2u) != 0u;
  a = has_first ? a : b;
  e = has_second ? e : b;
  ivec4 box1 = pixels_of_bounding_box(a.xy, b.xy, c.xy);
  ivec4 box2 = pixels_of_bounding_box(b.xy, e.xy, c.xy);
  ivec4 box = ivec4(min(box1.xy, box2.xy), max(box1.zw, box2.zw));
  Edges edges1 = edges_of(a.xy, b.xy, c.xy, box.xy * subpixels);
  Edges edges2 = edges_of(b.xy, e.xy, c.xy, box.xy * subpixels);
  vec3 inverse_z1 = vec3(inverse_z_of(a), inverse_z_of(b), inverse_z_of(c));
  vec3 inverse_z2 = vec3(inverse_z_of(b), inverse_z_of(e), inverse_z_of(c));

  for (int y = box.y; y <= box.w; ++y) {
    ivec3 value1 = edges1.value;
    ivec3 value2 = edges2.value;
    uint index = layer_index(layer, ivec2(box.x, y));
    for (int x = box.x; x <= box.z; ++x) {
      bool in_first = has_first && all(greaterThanEqual(value1, edges1.least));
      bool in_second = has_second && all(greaterThanEqual(value2, edges2.least));
      if (in_first || in_second) {
        vec3 weights;
        uint nearness = floatBitsToUint(
            inverse_z_from(vec3(in_second ? value2 : value1), in_second ? edges2.scale : edges1.scale,
                           in_second ? inverse_z2 : inverse_z1, weights));
#ifdef FIND_NEAREST
        atomicMax(layers[index], nearness);
#else
        if (layers[index] == nearness) {
          atomicMin(layers[index + 1u], 2u * cell + (in_second ? 1u : 0u));
        }
#endif
      }
      value1 += edges1.step_x;
      value2 += edges2.step_x;
      index += 2u;
    }
    edges1.value += edges1.step_y;
    edges2.value += edges2.step_y;
  }
}

void main() {
  uint stride = work.small_groups[0] * 64u;
  for (uint i = gl_GlobalInvocationID.x; i < work.small_count; i += stride) {
    draw(texelFetch(listed, int(i)).x);
  }
}
