// What draw_small and draw_large have found: looks up the one visible triangle.

// 1 / z as a float's bits in a pixel of the region; 0: the camera sees nothing.
uint kept_inverse_z_at(uint which, ivec2 pixel) { return layers[layer_index(which, pixel)]; }

// Where a pixel lies in the colour image of the current turn's camera.
vec2 seen_place(ivec2 pixel, float z) {
  uint id = layers[layer_index(layer, pixel) + 1u];
  uvec3 corners = corners_of(id);
  ivec4 a = position_of(corners.x);
  ivec4 b = position_of(corners.y);
  ivec4 c = position_of(corners.z);
  ivec2 point = pixel * subpixels;
  vec3 edges = vec3(edge_value(b.xy, c.xy, point), edge_value(c.xy, a.xy, point),
                    edge_value(a.xy, b.xy, point));
  float scale = 1.0 / cross_product(b.xy - a.xy, c.xy - a.xy);
  vec3 weights;
  inverse_z_from(edges, scale, vec3(inverse_z_of(a), inverse_z_of(b), inverse_z_of(c)), weights);
  return (weights.x * place_of(corners.x) + weights.y * place_of(corners.y) +
          weights.z * place_of(corners.z)) * z;
}

// Its colour there.
uint seen_color(ivec2 pixel, float z) { return sample_bilinear(seen_place(pixel, z)); }
