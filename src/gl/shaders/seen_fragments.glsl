// What geometry.frag has drawn: colour, and 1 / z as a float's bits; a layer for each camera.

layout(binding = 0) uniform usampler2DArray seen;

// 1 / z as a float's bits; 0: the camera sees nothing of the region.
uint inverse_z_at(uint which, ivec2 pixel) {
  return is_kept(pixel) ? texelFetch(seen, ivec3(pixel, which), 0).y : 0u;
}

// Of the camera whose turn it is.
uint seen_color(ivec2 pixel, float z) { return texelFetch(seen, ivec3(pixel, layer), 0).x; }
