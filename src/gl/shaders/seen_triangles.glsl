// What draw_small and draw_large have found: looks up the one triangle that is seen.

// A float's bits; 0: nothing is seen.
uint inverse_z_at(uint camera, ivec2 pixel) { return layers[layer_index(camera, pixel)]; }

uint color_at(uint camera, ivec2 pixel, float z) {
  uint id = layers[layer_index(camera, pixel) + 1u];
  uvec3 corners = corners_of(camera, id);
  ivec4 a = positions[corners.x];
  ivec4 b = positions[corners.y];
  ivec4 c = positions[corners.z];
  ivec2 point = pixel * subpixels;
  vec3 edges = vec3(edge_value(b.xy, c.xy, point), edge_value(c.xy, a.xy, point),
                    edge_value(a.xy, b.xy, point));
  float scale = 1.0 / cross_product(b.xy - a.xy, c.xy - a.xy);
  vec3 weights;
  inverse_z_from(edges, scale, vec3(inverse_z_of(a), inverse_z_of(b), inverse_z_of(c)), weights);
  vec2 place = (weights.x * places[corners.x] + weights.y * places[corners.y] +
                weights.z * places[corners.z]) * z;
  return sample_bilinear(camera, place);
}
