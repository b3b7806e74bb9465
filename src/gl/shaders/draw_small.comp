// Rules 4 and 5 of sdct.h: draws small triangles, one each.
// FIND_NEAREST: writes the nearest 1 / z of each pixel. Otherwise: of the triangles that are there,
// the first.

layout(local_size_x = 64) in;

void draw(uint id) {
  uvec3 corners = corners_of(id);
  ivec4 a = position_of(corners.x);
  ivec4 b = position_of(corners.y);
  ivec4 c = position_of(corners.z);
  ivec4 box = pixels_of_bounding_box(a.xy, b.xy, c.xy);
  vec3 inverse_z = vec3(inverse_z_of(a), inverse_z_of(b), inverse_z_of(c));
  float scale = 1.0 / cross_product(b.xy - a.xy, c.xy - a.xy);

  // Edge functions at the box's first pixel, and from a pixel to the next: small enough for 32 bits.
  ivec2 first = box.xy * subpixels;
  ivec3 step_x = ivec3(b.y - c.y, c.y - a.y, a.y - b.y);
  ivec3 step_y = ivec3(c.x - b.x, a.x - c.x, b.x - a.x);
  ivec3 edges = ivec3(step_x.x * (first.x - b.x) + step_y.x * (first.y - b.y),
                      step_x.y * (first.x - c.x) + step_y.y * (first.y - c.y),
                      step_x.z * (first.x - a.x) + step_y.z * (first.y - a.y));
  // Edges that are neither top nor left do not own the pixels on them.
  ivec3 least = ivec3(top_or_left(b.xy, c.xy) ? 0 : 1, top_or_left(c.xy, a.xy) ? 0 : 1,
                      top_or_left(a.xy, b.xy) ? 0 : 1);
  step_x *= subpixels;
  step_y *= subpixels;
  for (int y = box.y; y <= box.w; ++y) {
    ivec3 values = edges;
    uint index = layer_index(layer, ivec2(box.x, y));
    for (int x = box.x; x <= box.z; ++x) {
      if (all(greaterThanEqual(values, least))) {
        vec3 weights;
        uint nearness = floatBitsToUint(inverse_z_from(vec3(values), scale, inverse_z, weights));
#ifdef FIND_NEAREST
        atomicMax(layers[index], nearness);
#else
        if (layers[index] == nearness) atomicMin(layers[index + 1u], id);
#endif
      }
      values += step_x;
      index += 2u;
    }
    edges += step_y;
  }
}

void main() {
  uint stride = work.small_groups[0] * 64u;
  for (uint i = gl_GlobalInvocationID.x; i < work.small_count; i += stride) draw(texelFetch(listed, int(i)).x);
}
