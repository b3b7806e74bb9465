// What geometry.frag has drawn: colour, and 1 / z as a float's bits, one layer per camera.

layout(binding = 0) uniform usampler2DArray seen;

// 1 / z as a float's bits in a pixel of the region; 0: the camera sees nothing.
uint kept_inverse_z_at(uint which, ivec2 pixel) {
  return texelFetch(seen, ivec3(pixel, which), 0).y;
}

// Where a pixel lies in the colour image of the current turn's camera. Only the colour was drawn,
// so this goes back from the point.
vec2 seen_place(ivec2 pixel, float z) {
  vec3 point = z * vec3(undistort(color_lens, vec2(pixel)), 1);
  vec4 rows[3] = color_from_depth.rows;
  mat3 depth_from_color = mat3(rows[0].xyz, rows[1].xyz, rows[2].xyz);
  vec3 of_depth = depth_from_color * (point - vec3(rows[0].w, rows[1].w, rows[2].w));
  vec2 place;
  float rgbd_z;
  project(rgbd_color, rgbd_color_from_depth, of_depth, place, rgbd_z);
  return place;
}

// Its colour there.
uint seen_color(ivec2 pixel, float z) { return texelFetch(seen, ivec3(pixel, layer), 0).x; }
