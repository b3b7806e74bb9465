// What geometry.frag has drawn: colour, and 1 / z as a float's bits; a layer for each camera.

layout(binding = 0) uniform usampler2DArray seen;

// A float's bits; 0: nothing is seen.
uint inverse_z_at(uint camera, ivec2 pixel) { return texelFetch(seen, ivec3(pixel, camera), 0).y; }

uint color_at(uint camera, ivec2 pixel, float z) {
  return texelFetch(seen, ivec3(pixel, camera), 0).x;
}
