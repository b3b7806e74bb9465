// draw_small.comp for triangles of any size, each drawn by a work group, in exact arithmetic.

layout(local_size_x = 64) in;

void draw(uint id) {
  uvec3 corners = corners_of(id);
  ivec4 a = position_of(corners.x);
  ivec4 b = position_of(corners.y);
  ivec4 c = position_of(corners.z);
  ivec4 box = pixels_of_bounding_box(a.xy, b.xy, c.xy);
  vec3 inverse_z = vec3(inverse_z_of(a), inverse_z_of(b), inverse_z_of(c));
  float scale = 1.0 / cross_product(b.xy - a.xy, c.xy - a.xy);
  bvec3 owns_edge = bvec3(top_or_left(b.xy, c.xy), top_or_left(c.xy, a.xy), top_or_left(a.xy, b.xy));
  int width = box.z - box.x + 1;
  int pixels = width * (box.w - box.y + 1);
  for (int i = int(gl_LocalInvocationIndex); i < pixels; i += 64) {
    ivec2 pixel = box.xy + ivec2(i % width, i / width);
    ivec2 point = pixel * subpixels;
    vec3 edges = vec3(edge_value(b.xy, c.xy, point), edge_value(c.xy, a.xy, point),
                      edge_value(a.xy, b.xy, point));
    bvec3 on_owned = bvec3(edges.x == 0.0 && owns_edge.x, edges.y == 0.0 && owns_edge.y,
                           edges.z == 0.0 && owns_edge.z);
    bvec3 inside = greaterThan(edges, vec3(0));
    if (!((inside.x || on_owned.x) && (inside.y || on_owned.y) && (inside.z || on_owned.z))) continue;
    vec3 weights;
    uint nearness = floatBitsToUint(inverse_z_from(edges, scale, inverse_z, weights));
    uint index = layer_index(layer, pixel);
#ifdef FIND_NEAREST
    atomicMax(layers[index], nearness);
#else
    if (layers[index] == nearness) atomicMin(layers[index + 1u], id);
#endif
  }
}

void main() {
  for (uint i = gl_WorkGroupID.x; i < work.large_count; i += work.large_groups[0]) {
    draw(texelFetch(listed, textureSize(listed) - 1 - int(i)).x);
  }
}
